# The Debian packages: `cpack` in a build folder of a linux-* preset. zerorate is the node, libzerorate-dev the
# library.

include(GNUInstallDirs)
install(TARGETS zerorated DESTINATION "${CMAKE_INSTALL_SBINDIR}" COMPONENT node)
install(TARGETS zerorate DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT node)
install(FILES "${PROJECT_SOURCE_DIR}/firmware/boards/linux/zerorated.toml"
  DESTINATION "${CMAKE_INSTALL_FULL_SYSCONFDIR}/zerorate" COMPONENT node)
install(FILES "${PROJECT_SOURCE_DIR}/firmware/boards/linux/zerorated.service"
  DESTINATION lib/systemd/system COMPONENT node)
install(FILES "${PROJECT_SOURCE_DIR}/firmware/boards/linux/60-zerorate.rules"
  DESTINATION lib/udev/rules.d COMPONENT node)
install(FILES "${PROJECT_SOURCE_DIR}/firmware/wire/zerorate.dbc"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/zerorate" COMPONENT node)
install(FILES "${PROJECT_SOURCE_DIR}/docs/reference/zerorated.md"
  "${PROJECT_SOURCE_DIR}/docs/reference/rate-frame.md" "${PROJECT_SOURCE_DIR}/docs/reference/model-format.md"
  DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT node)
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}" RENAME copyright
  COMPONENT node)

foreach(page zerorate.1 zerorated.8 zerorated.toml.5)
  cmake_path(GET page EXTENSION LAST_ONLY section)
  string(SUBSTRING "${section}" 1 1 section)
  install(FILES "${PROJECT_SOURCE_DIR}/docs/man/${page}" DESTINATION "${CMAKE_INSTALL_MANDIR}/man${section}"
    COMPONENT node)
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME zerorate)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Bias-corrected rate of a MEMS gyroscope on Linux boards")
set(CPACK_PACKAGE_CONTACT "zerorate maintainers <maintainers@zerorate.invalid>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_SET_DESTDIR ON)  # the configuration stands outside of the prefix
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL node library)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_NODE_PACKAGE_NAME zerorate)
set(CPACK_DEBIAN_NODE_PACKAGE_SECTION science)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libzerorate-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "Headers of the gyro bias predictor and of its drivers; the predictor compiled, for C")
if(ZERORATE_DEBIAN_ARCH)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE ${ZERORATE_DEBIAN_ARCH})
endif()
set(_zerorate_gpiod libgpiod2)
if(libgpiod_VERSION VERSION_GREATER_EQUAL 2)
  set(_zerorate_gpiod libgpiod3)
endif()
set(CPACK_DEBIAN_NODE_PACKAGE_DEPENDS
  "libc6 (>= 2.34), libgcc-s1, libstdc++6 (>= 12), ${_zerorate_gpiod}, adduser")
set(CPACK_DEBIAN_NODE_PACKAGE_CONTROL_EXTRA
  "${PROJECT_SOURCE_DIR}/toolchains/debian/postinst;${PROJECT_SOURCE_DIR}/toolchains/debian/prerm;${PROJECT_SOURCE_DIR}/toolchains/debian/postrm;${PROJECT_SOURCE_DIR}/toolchains/debian/conffiles")
set(CPACK_DEBIAN_NODE_PACKAGE_CONTROL_STRICT_PERMISSION ON)
include(CPack)
