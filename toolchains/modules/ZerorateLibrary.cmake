# The library for other programs, installed by `cmake --install BUILD --component library`, from an mcu-* preset too:
# zerorate.h and libzerorate.a for firmware in C; the headers of everything that is flashed for C++, in a folder of
# their own, since they include each other from its root. Found by find_package(zerorate) and pkg-config.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(ZERORATE_INCLUDE "${CMAKE_INSTALL_INCLUDEDIR}")
set(ZERORATE_HEADERS "${ZERORATE_INCLUDE}/zerorate")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/firmware/c_api/include/" DESTINATION "${ZERORATE_INCLUDE}"
  COMPONENT library)
foreach(room core hal/contract drivers firmware/app firmware/wire)
  cmake_path(GET room PARENT_PATH above)
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/${room}" DESTINATION "${ZERORATE_HEADERS}/${above}"
    COMPONENT library FILES_MATCHING PATTERN "*.hpp" PATTERN "assert.cpp")
endforeach()
install(TARGETS zerorate_c_objects ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT library)
set(ZERORATE_LIBRARY "${CMAKE_INSTALL_LIBDIR}/libzerorate.a")
list(JOIN ZERORATE_ARITHMETIC_OPTIONS " " ZERORATE_ARITHMETIC)

set(package "${CMAKE_INSTALL_LIBDIR}/cmake/zerorate")
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/../package/zerorateConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/zerorateConfig.cmake" INSTALL_DESTINATION "${package}"
  PATH_VARS ZERORATE_INCLUDE ZERORATE_HEADERS ZERORATE_LIBRARY)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/zerorateConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
# find_package() shows the version of a package that it does not take: there stands why, and the cure.
file(APPEND "${PROJECT_BINARY_DIR}/zerorateConfigVersion.cmake"
  "if(PACKAGE_VERSION_UNSUITABLE)\n  string(APPEND PACKAGE_VERSION \", built for ${CMAKE_SYSTEM_PROCESSOR}: build and "
  "install zerorate with the toolchain file of your processor\")\nendif()\n")
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
