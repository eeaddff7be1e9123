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
