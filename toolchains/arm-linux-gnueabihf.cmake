# Debian on 32-bit Arm with a floating-point unit (ARMv7): BeagleBone, i.MX 6, ...
set(ZERORATE_TRIPLET arm-linux-gnueabihf)
set(ZERORATE_DEBIAN_ARCH armhf)
set(ZERORATE_EMULATOR qemu-arm)
set(CMAKE_SYSTEM_PROCESSOR armv7l)
include("${CMAKE_CURRENT_LIST_DIR}/linux-cross.cmake")

# GCC notes at each call with a std::span that GCC 7.1 passed it otherwise; nothing here is that old.
set(CMAKE_CXX_FLAGS_INIT "-Wno-psabi")
