# What all cross builds for Debian on Arm have in common. Included by one small file an architecture,
# which sets ZERORATE_TRIPLET and ZERORATE_DEBIAN_ARCH first.
#
# The compiler brings the C and C++ libraries; headers that are the same for every architecture come from
# this machine; the two libraries that are neither, libgpiod and zlib, are unpacked from Debian's packages of the target
# architecture into build/sysroot (toolchains/fetch-sysroot.sh), without touching this machine's packages.

set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_C_COMPILER ${ZERORATE_TRIPLET}-gcc)
set(CMAKE_CXX_COMPILER ${ZERORATE_TRIPLET}-g++)
set(CMAKE_LIBRARY_ARCHITECTURE ${ZERORATE_TRIPLET})
set(CMAKE_INSTALL_LIBDIR "lib/${ZERORATE_TRIPLET}" CACHE PATH "Debian's folder of the architecture")
set(CMAKE_SKIP_RPATH ON)  # the sysroot is no place on the target

# Debian 12 has libgpiod 1.6, Debian 13 (trixie) has 2: with its suite named here, it is built against.
set(ZERORATE_GPIOD_SUITE "" CACHE STRING "Suite of Debian that libgpiod is taken from; empty: this machine's")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES ZERORATE_GPIOD_SUITE)
set(_zerorate_gpiod libgpiod2)
if(ZERORATE_GPIOD_SUITE)
  set(_zerorate_gpiod libgpiod3)
endif()
set(_zerorate_sysroot "${CMAKE_CURRENT_LIST_DIR}/../build/sysroot/${ZERORATE_DEBIAN_ARCH}${ZERORATE_GPIOD_SUITE}")
cmake_path(NORMAL_PATH _zerorate_sysroot)
set(ZERORATE_SYSROOT "${_zerorate_sysroot}" CACHE INTERNAL "Where the libraries of the target are")
if(NOT EXISTS "${_zerorate_sysroot}/usr/include/gpiod.h")
  execute_process(COMMAND "${CMAKE_CURRENT_LIST_DIR}/fetch-sysroot.sh"
    ${ZERORATE_DEBIAN_ARCH} "${_zerorate_sysroot}" "${ZERORATE_GPIOD_SUITE}" libgpiod-dev ${_zerorate_gpiod}
    COMMAND_ERROR_IS_FATAL ANY)
endif()
if(NOT EXISTS "${_zerorate_sysroot}/usr/include/zlib.h")
  execute_process(COMMAND "${CMAKE_CURRENT_LIST_DIR}/fetch-sysroot.sh"
    ${ZERORATE_DEBIAN_ARCH} "${_zerorate_sysroot}" "${ZERORATE_GPIOD_SUITE}" zlib1g-dev
    COMMAND_ERROR_IS_FATAL ANY)
endif()
# What the tests need of the target's besides.
if(BUILD_TESTING AND NOT EXISTS "${_zerorate_sysroot}/usr/include/fmt")
  execute_process(COMMAND "${CMAKE_CURRENT_LIST_DIR}/fetch-sysroot.sh"
    ${ZERORATE_DEBIAN_ARCH} "${_zerorate_sysroot}" "${ZERORATE_GPIOD_SUITE}" libfmt-dev libfmt9 libgmock-dev libgtest-dev
    COMMAND_ERROR_IS_FATAL ANY)
endif()
set(ZLIB_USE_STATIC_LIBS ON)  # the link to the shared one leads out of the sysroot
set(CMAKE_CROSSCOMPILING_EMULATOR ${ZERORATE_EMULATOR} -L "/usr/${ZERORATE_TRIPLET}"
    -E "LD_LIBRARY_PATH=${_zerorate_sysroot}/usr/lib/${ZERORATE_TRIPLET}")
set(ENV{PKG_CONFIG_LIBDIR} "${_zerorate_sysroot}/usr/lib/${ZERORATE_TRIPLET}/pkgconfig")
set(ENV{PKG_CONFIG_SYSROOT_DIR} "${_zerorate_sysroot}")

# Libraries of the target only; headers and packages of headers from here too.
set(CMAKE_FIND_ROOT_PATH "${_zerorate_sysroot}" "/usr/${ZERORATE_TRIPLET}")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE BOTH)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH)
