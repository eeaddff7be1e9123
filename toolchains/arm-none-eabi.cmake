# What all bare-metal Arm targets have in common. Included by one small file a processor, which sets
# ZERORATE_CPU_FLAGS first.

set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)

set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)

# There is neither a start-up file nor a C library to link a test program with.
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)

# No exceptions, no RTTI, no guards around function-local statics and no unwind tables: each of them
# drags in code that allocates or aborts. Sections are cut so that the linker drops what no image uses.
set(_zerorate_bare_metal
  "${ZERORATE_CPU_FLAGS} -mthumb -ffreestanding -ffunction-sections -fdata-sections -fno-unwind-tables -fno-asynchronous-unwind-tables")
set(CMAKE_C_FLAGS_INIT "${_zerorate_bare_metal}")
set(CMAKE_CXX_FLAGS_INIT "${_zerorate_bare_metal} -fno-exceptions -fno-rtti -fno-threadsafe-statics")
