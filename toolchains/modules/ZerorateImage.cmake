# How an image for a microcontroller is linked, and the gates without which its build fails.

include_guard()
find_package(Python3 3.11 REQUIRED COMPONENTS Interpreter)
find_program(ZERORATE_NM arm-none-eabi-nm REQUIRED)
find_program(ZERORATE_OBJDUMP arm-none-eabi-objdump REQUIRED)
find_program(ZERORATE_SIZE arm-none-eabi-size REQUIRED)
set(ZERORATE_IMAGE_GATE "${CMAKE_CURRENT_LIST_DIR}/../gates/image_gate.py")
set(ZERORATE_STACK_GATE "${CMAKE_CURRENT_LIST_DIR}/../gates/stack_depth.py")
set(ZERORATE_RP2040_IMAGE "${CMAKE_CURRENT_LIST_DIR}/../images/rp2040_image.py")

# zerorate_image(NAME LINKER_SCRIPT file SOURCES files... DEPENDS targets...)
#
# NAME.elf, linked against nothing but our own code and the compiler's arithmetic (libgcc): a call of
# malloc, operator new, printf or abort is an undefined reference. The gate then reads the symbols of
# the finished image, for what came in by another way.
function(zerorate_image name)
  cmake_parse_arguments(image "" "LINKER_SCRIPT" "SOURCES;DEPENDS" ${ARGN})
  cmake_path(ABSOLUTE_PATH image_LINKER_SCRIPT)
  add_executable(${name} ${image_SOURCES})
  set_target_properties(${name} PROPERTIES SUFFIX ".elf" LINK_DEPENDS "${image_LINKER_SCRIPT}")
  target_link_libraries(${name} PRIVATE zerorate_target_flags ${image_DEPENDS} -lgcc)
  target_link_options(${name} PRIVATE
    -nostartfiles -nodefaultlibs "-T${image_LINKER_SCRIPT}"
    -Wl,--gc-sections -Wl,--fatal-warnings "-Wl,-Map=$<TARGET_FILE:${name}>.map")
  add_custom_command(TARGET ${name} POST_BUILD VERBATIM
    COMMAND "${Python3_EXECUTABLE}" "${ZERORATE_IMAGE_GATE}" --nm "${ZERORATE_NM}"
            --size "${ZERORATE_SIZE}" "$<TARGET_FILE:${name}>")
endfunction()

# stack_gate(NAME INTERRUPTS handlers...): refuses NAME.elf where its stack can become deeper than it
# reserves. Handlers of one priority are one argument, with commas between them; lower priorities first.
function(stack_gate name)
  cmake_parse_arguments(gate "" "" "INTERRUPTS" ${ARGN})
  list(TRANSFORM gate_INTERRUPTS PREPEND "--interrupts=")
  add_custom_command(TARGET ${name} POST_BUILD VERBATIM
    COMMAND "${Python3_EXECUTABLE}" -B "${ZERORATE_STACK_GATE}" --objdump "${ZERORATE_OBJDUMP}"
            --nm "${ZERORATE_NM}" ${gate_INTERRUPTS} "$<TARGET_FILE:${name}>")
endfunction()

# rp2040_files(NAME): seals the second boot stage of NAME.elf and writes NAME.bin and NAME.uf2.
function(rp2040_files name)
  add_custom_command(TARGET ${name} POST_BUILD VERBATIM
    COMMAND "${Python3_EXECUTABLE}" -B "${ZERORATE_RP2040_IMAGE}" "$<TARGET_FILE:${name}>"
    BYPRODUCTS ${name}.bin ${name}.uf2)
endfunction()
