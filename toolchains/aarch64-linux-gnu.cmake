# Debian on 64-bit Arm: Raspberry Pi 3 and later with a 64-bit system, i.MX 8, ...
set(ZERORATE_TRIPLET aarch64-linux-gnu)
set(ZERORATE_DEBIAN_ARCH arm64)
set(ZERORATE_EMULATOR qemu-aarch64)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
include("${CMAKE_CURRENT_LIST_DIR}/linux-cross.cmake")
