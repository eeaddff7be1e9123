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
