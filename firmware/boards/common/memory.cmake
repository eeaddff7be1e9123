# How memory.cpp of zerorate_boards_common is compiled, and what a processor without floating point needs besides. For
# CMakeLists.txt and for the images that must not be built (host_tests/guards/offenders).

# Otherwise the compiler recognises the loop of memset and replaces it by a call of memset.
target_compile_options(zerorate_boards_common PRIVATE -fno-tree-loop-distribute-patterns)
if(ZERORATE_CPU STREQUAL "cortex-m0plus")
  enable_language(ASM)
  target_sources(zerorate_boards_common PRIVATE "${CMAKE_CURRENT_LIST_DIR}/soft_float.S"
    "${CMAKE_CURRENT_LIST_DIR}/soft_float.cpp")
endif()
