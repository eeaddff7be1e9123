# The library for other programs: the headers of everything that is flashed, and compiled, the interface for
# firmware in C (firmware/c_api); found by find_package(zerorate) and pkg-config. Headers stand in a folder of
# their own, since they include each other from its root.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(ZERORATE_HEADERS "${CMAKE_INSTALL_INCLUDEDIR}/zerorate")
foreach(room core hal/contract drivers firmware/app firmware/c_api firmware/wire)
  cmake_path(GET room PARENT_PATH above)
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/${room}" DESTINATION "${ZERORATE_HEADERS}/${above}"
    COMPONENT library FILES_MATCHING PATTERN "*.hpp" PATTERN "zerorate.h" PATTERN "assert.cpp" PATTERN examples EXCLUDE)
endforeach()

add_library(zerorate_c STATIC $<TARGET_OBJECTS:zerorate_firmware_c_api> $<TARGET_OBJECTS:zerorate_core_base>)
set_target_properties(zerorate_c PROPERTIES OUTPUT_NAME zerorate LINKER_LANGUAGE CXX)
install(TARGETS zerorate_c ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT library)
set(ZERORATE_LIBRARY "${CMAKE_INSTALL_LIBDIR}/libzerorate.a")

set(package "${CMAKE_INSTALL_LIBDIR}/cmake/zerorate")
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/../package/zerorateConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/zerorateConfig.cmake" INSTALL_DESTINATION "${package}"
  PATH_VARS ZERORATE_HEADERS ZERORATE_LIBRARY)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/zerorateConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/zerorateConfig.cmake" "${PROJECT_BINARY_DIR}/zerorateConfigVersion.cmake"
  DESTINATION "${package}" COMPONENT library)

# zerorate is for C++, from headers; zerorate-c for C, to be linked.
set(ZERORATE_PKGCONFIG "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
cmake_path(RELATIVE_PATH CMAKE_INSTALL_PREFIX BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}/${ZERORATE_PKGCONFIG}"
  OUTPUT_VARIABLE ZERORATE_PREFIX)
foreach(name zerorate zerorate-c)
  configure_file("${CMAKE_CURRENT_LIST_DIR}/../package/${name}.pc.in" "${PROJECT_BINARY_DIR}/${name}.pc" @ONLY)
  install(FILES "${PROJECT_BINARY_DIR}/${name}.pc" DESTINATION "${ZERORATE_PKGCONFIG}" COMPONENT library)
endforeach()
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs/examples/library" "${PROJECT_SOURCE_DIR}/docs/examples/c"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/libzerorate-dev/examples" COMPONENT library)
