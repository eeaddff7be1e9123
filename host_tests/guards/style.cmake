# clang-format over all of our C++. clang-tidy is a step of `./test --all`: toolchains/tidy.py.

set(cpp_files)
foreach(folder core hal drivers firmware host_tools host_tests)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS RELATIVE "${PROJECT_SOURCE_DIR}"
    "${PROJECT_SOURCE_DIR}/${folder}/*.hpp" "${PROJECT_SOURCE_DIR}/${folder}/*.cpp"
    "${PROJECT_SOURCE_DIR}/${folder}/*.h" "${PROJECT_SOURCE_DIR}/${folder}/*.c")
  list(APPEND cpp_files ${files})
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
if(ZERORATE_QUICK_TESTS)
  return()
endif()

# cppcheck's MISRA C:2012 addon over the C interface and its example in C. Four rules are deviated from:
# docs/reference/c-interface.md says why.

set(misra_command cppcheck --std=c11 --language=c --addon=misra --enable=style --quiet --error-exitcode=1
    --suppress=unusedFunction --suppress=missingIncludeSystem
    --suppress=misra-c2012-1.4 --suppress=misra-c2012-2.4 --suppress=misra-c2012-2.5 --suppress=misra-c2012-20.10)
add_test(NAME style.misra
  COMMAND ${misra_command} -I . -I firmware/c_api/include firmware/c_api/examples/heading.c
  WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}")
set_tests_properties(style.misra PROPERTIES LABELS style TIMEOUT 120)

# The negative control: a jump (rule 15.1).
file(WRITE "${CMAKE_CURRENT_BINARY_DIR}/jumps.c" "static int f(int a) { again: a--; if (a > 0) { goto again; } return a; }\nint main(void) { return f(3); }\n")
add_test(NAME style.a_jump_is_refused COMMAND ${misra_command} "${CMAKE_CURRENT_BINARY_DIR}/jumps.c")
set_tests_properties(style.a_jump_is_refused PROPERTIES LABELS style
  PASS_REGULAR_EXPRESSION "misra-c2012-15.1")

# API pages from the comments of the headers. A comment that Doxygen cannot read fails the test.

find_program(DOXYGEN doxygen)
if(NOT DOXYGEN)
  return()  # ./test --all installs it
endif()

configure_file("${PROJECT_SOURCE_DIR}/docs/Doxyfile.in" "${CMAKE_CURRENT_BINARY_DIR}/Doxyfile" @ONLY)
file(MAKE_DIRECTORY "${CMAKE_BINARY_DIR}/api")
add_custom_target(api_pages COMMAND "${DOXYGEN}" "${CMAKE_CURRENT_BINARY_DIR}/Doxyfile"
  COMMENT "API pages: ${CMAKE_BINARY_DIR}/api/html/index.html" VERBATIM)
add_test(NAME guards.api_pages COMMAND "${DOXYGEN}" "${CMAKE_CURRENT_BINARY_DIR}/Doxyfile")
set_tests_properties(guards.api_pages PROPERTIES LABELS guards TIMEOUT 300)

# The negative control: a parameter that the function does not have.
file(WRITE "${CMAKE_CURRENT_BINARY_DIR}/undocumentable/offender.hpp"
  "/// @file\n\n/// Rate.\n/// @param gone no such parameter\nint rate(int axis);\n")
file(READ "${CMAKE_CURRENT_BINARY_DIR}/Doxyfile" offender)
string(APPEND offender "INPUT = \"${CMAKE_CURRENT_BINARY_DIR}/undocumentable\"\n"
  "USE_MDFILE_AS_MAINPAGE =\nOUTPUT_DIRECTORY = \"${CMAKE_CURRENT_BINARY_DIR}/undocumentable\"\n")
file(WRITE "${CMAKE_CURRENT_BINARY_DIR}/Doxyfile.offender" "${offender}")
add_test(NAME guards.undocumentable_code_is_refused
  COMMAND "${DOXYGEN}" "${CMAKE_CURRENT_BINARY_DIR}/Doxyfile.offender")
set_tests_properties(guards.undocumentable_code_is_refused PROPERTIES LABELS guards TIMEOUT 60
  PASS_REGULAR_EXPRESSION "argument 'gone'")
