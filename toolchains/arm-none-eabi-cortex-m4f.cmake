# Cortex-M4 with the single-precision floating-point unit.
set(ZERORATE_CPU cortex-m4f)
set(ZERORATE_CPU_FLAGS "-mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=hard")
include("${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake")
