# How every target of the project is compiled, and the one way to declare a leaf of the house.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_C_STANDARD 11)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release)
endif()
# Fixed-size kernels are smaller and faster at -O2 than at -Os or -O3 (docs/adr).
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
# The sanitizers at -O0 take several times as long; of the symbols they need the lines only. The library checks indices
# and arguments as well.
set(CMAKE_CXX_FLAGS_DEBUG "-O1 -g1 -D_GLIBCXX_ASSERTIONS")
# Daily work: compiled in two thirds of the time, and fast enough for the tests. GCC collects its garbage later, which
# costs up to 400 MB of memory a compiler and saves 5 to 10 % of its time.
set(CMAKE_CXX_FLAGS_DEV "-O1 -DNDEBUG")
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  string(APPEND CMAKE_CXX_FLAGS_DEV " --param=ggc-min-heapsize=512000")
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  # Relative paths, so that a second clone finds what the first one compiled. The sloppiness is what ccache asks
  # for where a header is precompiled.
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CMAKE_COMMAND}" -E env
      "CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}" CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros
      "${CCACHE_PROGRAM}")
endif()

option(ZERORATE_SANITIZE "Build with the address and undefined-behaviour sanitizers" OFF)
option(ZERORATE_COVERAGE "Let unit and contract tests count the lines and branches that they reach (GCC)" OFF)
option(ZERORATE_FUZZ "Let all code tell the fuzzers what of it was reached (clang)" OFF)

# Flags of all our own code. Designated initialisers rely on member defaults, so their warning is
# off.
add_library(zerorate_flags INTERFACE)
# Warnings that follow the values through a function: at -O1 GCC 12 sees half of the way and gives them for copies of
# empty vectors and the like. Every build at -O2 has them.
set(ZERORATE_WARNINGS_OF_O2 "-Wno-nonnull;-Wno-stringop-overflow;-Wno-stringop-overread;-Wno-array-bounds;-Wno-restrict;-Wno-maybe-uninitialized")
target_compile_options(zerorate_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wno-missing-field-initializers -Wshadow -Wconversion -Wsign-conversion
  $<$<COMPILE_LANGUAGE:CXX>:-Wold-style-cast> $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor>
  $<$<COMPILE_LANGUAGE:CXX>:-Woverloaded-virtual> -Wcast-align -Wimplicit-fallthrough -Werror
  "$<$<CONFIG:Dev>:${ZERORATE_WARNINGS_OF_O2}>"
  ${ZERORATE_ARITHMETIC_OPTIONS} $<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes>)
target_include_directories(zerorate_flags INTERFACE "${PROJECT_SOURCE_DIR}")
if(ZERORATE_SANITIZE)
  # Sizes of objects are left to the address sanitizer, which sees the real ones: that check takes a sixth of the compiler's
  # time.
  target_compile_options(zerorate_flags INTERFACE
    -fsanitize=address,undefined -fno-sanitize=object-size -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(zerorate_flags INTERFACE -fsanitize=address,undefined)
endif()
if(ZERORATE_FUZZ)
  target_compile_options(zerorate_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()

# Additional promises of code that is flashed: single precision only, and small stack frames.
set(ZERORATE_STACK_FRAME_CEILING 1536 CACHE STRING "Largest stack frame of a function on the target, bytes")
add_library(zerorate_target_flags INTERFACE)
target_link_libraries(zerorate_target_flags INTERFACE zerorate_flags)
# Hosted code that links to the core gets these flags with it. clang counts an assignment of a float
# to a double as a promotion too, which such code makes on purpose; GCC, which builds the images, warns
# of arithmetic only.
target_compile_options(zerorate_target_flags INTERFACE
  $<$<CXX_COMPILER_ID:GNU>:-Wdouble-promotion>)
if(CMAKE_SYSTEM_NAME STREQUAL "Generic")
  target_compile_options(zerorate_target_flags INTERFACE
    -fstack-usage -Wstack-usage=${ZERORATE_STACK_FRAME_CEILING})
endif()

# Precompiled headers of hosted code. A file that forgets an include fails in toolchains/tidy.py, a header in
# all_verify_interface_header_sets.
option(ZERORATE_PRECOMPILED_HEADERS "Precompile the standard library's headers for hosted code" OFF)

# zerorate_precompiled_headers(NAME HEADERS headers... DEPENDS targets... [OPTIONS options...])
#
# Precompiles the headers once, for every target that asks for them by zerorate_use_precompiled_headers(target NAME) and
# has the same compile options.
function(zerorate_precompiled_headers name)
  cmake_parse_arguments(pch "" "" "HEADERS;DEPENDS;OPTIONS" ${ARGN})
  if(NOT ZERORATE_PRECOMPILED_HEADERS)
    return()
  endif()
  set(source "${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp")
  file(CONFIGURE OUTPUT "${source}" CONTENT "// Stands for the compile options of the precompiled headers.\n")
  add_library(${name} OBJECT "${source}")
  target_link_libraries(${name} PRIVATE zerorate_target_flags ${pch_DEPENDS})
  target_compile_options(${name} PRIVATE ${pch_OPTIONS})
  target_precompile_headers(${name} PRIVATE ${pch_HEADERS})
  # CMake writes the header anew in each build folder: its time of change says nothing, and ccache knows the contents.
  target_compile_options(${name} PRIVATE "$<$<CXX_COMPILER_ID:Clang>:SHELL:-Xclang -fno-pch-timestamp>")
endfunction()

function(zerorate_use_precompiled_headers target name)
  if(TARGET ${name})
    target_precompile_headers(${target} REUSE_FROM ${name})
  endif()
endfunction()

set(ZERORATE_STANDARD_HEADERS <algorithm> <array> <cmath> <cstdint> <functional> <map> <memory> <optional> <span>
  <stdexcept> <string> <string_view> <utility> <variant> <vector>)
zerorate_precompiled_headers(zerorate_standard_headers HEADERS ${ZERORATE_STANDARD_HEADERS})

option(ZERORATE_EVERY_HEADER "Compile each header of host_tools on its own, too" OFF)

# zerorate_leaf(NAME [HOSTED] [FOLDER folder] [SOURCES files...] [DEPENDS targets...])
#
# Declares the library of a folder (that of the CMakeLists.txt unless given; SOURCES are relative to it) as
# zerorate_NAME with the alias zerorate::NAME. Each folder with headers has one.
# Without SOURCES it is a header-only (INTERFACE) library. HOSTED leaves may use an operating
# system, double precision and exceptions; the others are compiled for the microcontrollers too.
# The folder's headers form a header set: the target all_verify_interface_header_sets compiles each
# of them on its own, so that a template which nothing uses yet is still compiled for every processor: what is flashed
# for the microcontrollers, hosted headers on the host, those of host_tools in `./test --slow` alone.
function(zerorate_leaf name)
  cmake_parse_arguments(leaf "HOSTED" "FOLDER" "SOURCES;DEPENDS" ${ARGN})
  cmake_path(APPEND CMAKE_CURRENT_SOURCE_DIR "${leaf_FOLDER}" OUTPUT_VARIABLE folder)
  list(TRANSFORM leaf_SOURCES PREPEND "${folder}/" REGEX "^[^/]")
  set(flags zerorate_target_flags)
  if(leaf_HOSTED)
    set(flags zerorate_flags)
  endif()
  if(leaf_SOURCES)
    add_library(zerorate_${name} STATIC ${leaf_SOURCES})
    target_link_libraries(zerorate_${name} PUBLIC ${flags} ${leaf_DEPENDS})
    if(leaf_HOSTED AND leaf_DEPENDS MATCHES "fmt::fmt")
      zerorate_use_precompiled_headers(zerorate_${name} zerorate_text_headers)
    elseif(leaf_HOSTED)
      zerorate_use_precompiled_headers(zerorate_${name} zerorate_standard_headers)
    endif()
  else()
    add_library(zerorate_${name} INTERFACE)
    target_link_libraries(zerorate_${name} INTERFACE ${flags} ${leaf_DEPENDS})
  endif()
  file(GLOB headers CONFIGURE_DEPENDS "${folder}/*.hpp")
  if(headers)
    target_sources(zerorate_${name} INTERFACE
      FILE_SET HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}" FILES ${headers})
    set(is_tool OFF)
    if(folder MATCHES "^${PROJECT_SOURCE_DIR}/host_tools/" AND NOT ZERORATE_EVERY_HEADER)
      set(is_tool ON)
    endif()
    if((leaf_HOSTED AND NOT is_tool) OR CMAKE_SYSTEM_NAME STREQUAL "Generic")
      set_target_properties(zerorate_${name} PROPERTIES VERIFY_INTERFACE_HEADER_SETS ON)
    endif()
  endif()
  add_library(zerorate::${name} ALIAS zerorate_${name})
endfunction()
