# clang-format over all of our C++, clang-tidy over all of it that is not a test.

option(ZERORATE_TIDY "Make one test of each file that clang-tidy checks (minutes, not seconds)" OFF)

set(cpp_files)
set(tidy_files)
foreach(folder core hal drivers firmware host_tools host_tests)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS RELATIVE "${PROJECT_SOURCE_DIR}"
    "${PROJECT_SOURCE_DIR}/${folder}/*.hpp" "${PROJECT_SOURCE_DIR}/${folder}/*.cpp"
    "${PROJECT_SOURCE_DIR}/${folder}/*.h" "${PROJECT_SOURCE_DIR}/${folder}/*.c")
  list(APPEND cpp_files ${files})
  if(NOT folder STREQUAL "host_tests")
    list(FILTER files INCLUDE REGEX "pp$")  # C has a check of its own, misra.cmake
    list(APPEND tidy_files ${files})
  endif()
endforeach()

add_test(NAME style.format COMMAND clang-format --dry-run -Werror ${cpp_files}
  WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}")
set_tests_properties(style.format PROPERTIES LABELS style TIMEOUT 120)

# The negative control: a file of one line that no style allows.
file(WRITE "${CMAKE_CURRENT_BINARY_DIR}/badly_formatted.cpp" "int  main( ){return 0 ;}\n")
add_test(NAME style.bad_format_is_refused
  COMMAND clang-format --dry-run -Werror --style=file:${PROJECT_SOURCE_DIR}/.clang-format
          "${CMAKE_CURRENT_BINARY_DIR}/badly_formatted.cpp")
set_tests_properties(style.bad_format_is_refused PROPERTIES LABELS style
  PASS_REGULAR_EXPRESSION "code should be clang-formatted")

if(NOT ZERORATE_TIDY)
  return()
endif()
# The negative control, then one test for each source file, which answers for the headers of its
# folder too. What is flashed is mostly headers: there each is checked on its own (with the compile
# command of the file that is nearest by name).
file(WRITE "${CMAKE_CURRENT_BINARY_DIR}/untidy.cpp" "int* nowhere() { return 0; }\n")
add_test(NAME style.untidy_code_is_refused
  COMMAND clang-tidy --quiet --config-file=${PROJECT_SOURCE_DIR}/.clang-tidy
          "${CMAKE_CURRENT_BINARY_DIR}/untidy.cpp" -- -std=c++20)
set_tests_properties(style.untidy_code_is_refused PROPERTIES LABELS style
  PASS_REGULAR_EXPRESSION "error: use nullptr")
# Of the two sources for libgpiod only the one that this machine builds means anything here.
get_target_property(hal_linux_sources zerorate_hal_linux SOURCES)
foreach(file ${tidy_files})
  cmake_path(GET file PARENT_PATH folder)
  cmake_path(GET file FILENAME name)
  if(name MATCHES "^gpio_line_v.*\\.cpp$" AND NOT "${hal_linux_sources}" MATCHES "${name}")
    continue()
  endif()
  if(file MATCHES "\\.hpp$" AND folder MATCHES "^(host_tools/|firmware/model|hal/(sim|testing|linux))")
    continue()
  endif()
  # The compile commands are GCC's; not every flag of it means something to clang.
  add_test(NAME tidy.${file}
    COMMAND clang-tidy --quiet "--header-filter=/${folder}/[^/]*[.]hpp$" --extra-arg=-Wno-double-promotion
            --extra-arg=-Wno-ignored-optimization-argument -p "${CMAKE_BINARY_DIR}" "${file}"
    WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}")
  set_tests_properties(tidy.${file} PROPERTIES LABELS style TIMEOUT 300)
endforeach()
