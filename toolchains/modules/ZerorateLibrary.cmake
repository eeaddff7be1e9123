# The library for other programs: the headers of everything that is flashed, found by find_package(zerorate)
# and pkg-config. Headers stand in a folder of their own, since they include each other from its root.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(ZERORATE_HEADERS "${CMAKE_INSTALL_INCLUDEDIR}/zerorate")
foreach(room core hal/contract drivers firmware/app firmware/wire)
  cmake_path(GET room PARENT_PATH above)
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/${room}" DESTINATION "${ZERORATE_HEADERS}/${above}"
    COMPONENT library FILES_MATCHING PATTERN "*.hpp" PATTERN "assert.cpp")
endforeach()

set(package "${CMAKE_INSTALL_DATADIR}/cmake/zerorate")  # of no architecture
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/../package/zerorateConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/zerorateConfig.cmake" INSTALL_DESTINATION "${package}" PATH_VARS ZERORATE_HEADERS)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/zerorateConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES "${PROJECT_BINARY_DIR}/zerorateConfig.cmake" "${PROJECT_BINARY_DIR}/zerorateConfigVersion.cmake"
  DESTINATION "${package}" COMPONENT library)

configure_file("${CMAKE_CURRENT_LIST_DIR}/../package/zerorate.pc.in" "${PROJECT_BINARY_DIR}/zerorate.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/zerorate.pc" DESTINATION "${CMAKE_INSTALL_DATADIR}/pkgconfig"
  COMPONENT library)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs/examples/library"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/libzerorate-dev/examples" COMPONENT library)
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/libzerorate-dev"
  RENAME copyright COMPONENT library)
