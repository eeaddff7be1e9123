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
install(FILES "${PROJECT_SOURCE_DIR}/firmware/wire/zerorate.dbc" "${PROJECT_SOURCE_DIR}/firmware/wire/zerorate_yaw.dbc"
  "${PROJECT_SOURCE_DIR}/firmware/wire/zerorate_fd.dbc"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/zerorate" COMPONENT node)
install(FILES "${PROJECT_SOURCE_DIR}/host_tools/cli/completion/zerorate.bash"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" RENAME zerorate COMPONENT node)
install(FILES "${PROJECT_SOURCE_DIR}/host_tools/cli/completion/_zerorate"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions" COMPONENT node)
install(FILES "${PROJECT_SOURCE_DIR}/docs/examples/c/receive_rate.c"
  "${PROJECT_SOURCE_DIR}/docs/examples/python/receive_rate.py"
  DESTINATION "${CMAKE_INSTALL_DATAROOTDIR}/doc/zerorate/examples" COMPONENT node)
install(FILES "${PROJECT_SOURCE_DIR}/docs/reference/zerorated.md"
  "${PROJECT_SOURCE_DIR}/docs/reference/rate-frame.md" "${PROJECT_SOURCE_DIR}/docs/reference/model-format.md"
  DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT node)
# zerorate_install_compressed(FILE DESTINATION COMPONENT): as Debian wants manual pages and changelogs.
find_program(GZIP_PROGRAM gzip REQUIRED)
function(zerorate_install_compressed file destination component)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
  cmake_path(GET file FILENAME name)
  set(compressed "${PROJECT_BINARY_DIR}/compressed/${name}.gz")
  file(MAKE_DIRECTORY "${PROJECT_BINARY_DIR}/compressed")
  execute_process(COMMAND "${GZIP_PROGRAM}" --best --no-name --stdout "${file}" OUTPUT_FILE "${compressed}"
    COMMAND_ERROR_IS_FATAL ANY)
  install(FILES "${compressed}" DESTINATION "${destination}" COMPONENT "${component}")
endfunction()

foreach(page zerorate.1 zerorated.8 zerorated.toml.5)
  cmake_path(GET page EXTENSION LAST_ONLY section)
  string(SUBSTRING "${section}" 1 1 section)
  zerorate_install_compressed("${PROJECT_SOURCE_DIR}/docs/man/${page}" "${CMAKE_INSTALL_MANDIR}/man${section}" node)
endforeach()
file(WRITE "${PROJECT_BINARY_DIR}/changelog" "zerorate (${PROJECT_VERSION}) bookworm; urgency=medium

  * See CHANGELOG.md of the sources.

 -- zerorate maintainers <maintainers@zerorate.invalid>  Mon, 23 Nov 2026 12:00:00 +0000
")
file(WRITE "${PROJECT_BINARY_DIR}/conffiles" "/etc/zerorate/zerorated.toml\n")
foreach(package_and_component zerorate:node libzerorate-dev:library python3-zerorate:python)
  string(REPLACE ":" ";" package_and_component "${package_and_component}")
  list(GET package_and_component 0 package)
  list(GET package_and_component 1 component)
  set(documents "${CMAKE_INSTALL_DATAROOTDIR}/doc/${package}")
  install(FILES "${PROJECT_SOURCE_DIR}/toolchains/debian/copyright" DESTINATION "${documents}" COMPONENT ${component})
  zerorate_install_compressed("${PROJECT_BINARY_DIR}/changelog" "${documents}" ${component})
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME zerorate)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Bias-corrected rate of a MEMS gyroscope on Linux boards")
set(CPACK_COMPONENT_NODE_DESCRIPTION
"Reads a MEMS gyroscope by SPI or I2C and an odometer by GPIO, CAN or a
socket, learns the bias of the gyroscope and its noise whenever the
vehicle stands, and publishes the corrected rate with an interval by UDP,
Unix sockets, CAN and JSON lines. The tool zerorate finds, watches and
records such a gyroscope.")
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
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION
"The bias predictor of zerorate for programs and firmware of their own:
headers in C++, the predictor compiled with an interface in C, and drivers
of gyroscopes.")
# In a build with ZERORATE_PYTHON alone: cpack --config CPackPython.cmake.
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-zerorate)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.11), python3 (<< 3.12), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS python3-matplotlib)
set(CPACK_COMPONENT_PYTHON_DESCRIPTION
"The tools of zerorate for NumPy arrays: recordings, Allan deviation,
noise of a gyroscope, diagnosis, and the node of the firmware.")
if(ZERORATE_DEBIAN_ARCH)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE ${ZERORATE_DEBIAN_ARCH})
endif()
set(_zerorate_gpiod libgpiod2)
if(libgpiod_VERSION VERSION_GREATER_EQUAL 2)
  set(_zerorate_gpiod libgpiod3)
endif()
set(CPACK_DEBIAN_NODE_PACKAGE_DEPENDS
  "libc6 (>= 2.34), libgcc-s1, libstdc++6 (>= 12), ${_zerorate_gpiod}, adduser")
if(NOT CMAKE_CROSSCOMPILING)  # a cross build links it statically
  string(APPEND CPACK_DEBIAN_NODE_PACKAGE_DEPENDS ", zlib1g")
endif()
set(CPACK_DEBIAN_NODE_PACKAGE_CONTROL_EXTRA
  "${PROJECT_SOURCE_DIR}/toolchains/debian/postinst;${PROJECT_SOURCE_DIR}/toolchains/debian/prerm;${PROJECT_SOURCE_DIR}/toolchains/debian/postrm;${PROJECT_BINARY_DIR}/conffiles")
set(CPACK_DEBIAN_NODE_PACKAGE_CONTROL_STRICT_PERMISSION ON)
include(CPack)
