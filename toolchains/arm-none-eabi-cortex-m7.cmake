# Cortex-M7 with the double-precision floating-point unit, of which single precision is used.
set(ZERORATE_CPU cortex-m7)
set(ZERORATE_CPU_FLAGS "-mcpu=cortex-m7 -mfpu=fpv5-d16 -mfloat-abi=hard")
include("${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake")
