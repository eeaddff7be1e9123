# Cortex-M0+, the processor of the RP2040: no floating-point unit, no divide instruction.
set(ZERORATE_CPU cortex-m0plus)
set(ZERORATE_CPU_FLAGS "-mcpu=cortex-m0plus")
include("${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake")
