# Images with one mistake each, which the emulated board must notice (mutants.test.mjs). A mutant is the
# Pico's image with one place of one header replaced; the place must still be there, exactly once.

# A mistake may take more memory than the image has: two predictors instead of one.
pico_memory(mutant.ld 68K 10240 2560)

# pico_mutant(NAME file from to [options of pico_image...])
function(pico_mutant name file from to)
  file(READ "${PROJECT_SOURCE_DIR}/${file}" text)
  string(FIND "${text}" "${from}" first)
  string(FIND "${text}" "${from}" last REVERSE)
  if(first EQUAL -1 OR NOT first EQUAL last)
    message(FATAL_ERROR "mutant ${name}: ${file} does not hold its text exactly once")
  endif()
  string(REPLACE "${from}" "${to}" text "${text}")
  set(folder "${CMAKE_CURRENT_BINARY_DIR}/mutants/${name}")
  file(CONFIGURE OUTPUT "${folder}/${file}" CONTENT "${text}" @ONLY)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/${file}")
  pico_image(mutant-${name} SPI MEMORY mutant.ld ${ARGN})
  if(file MATCHES "[.]cpp$")  # instead of the one in the library
    target_sources(mutant-${name} PRIVATE "${folder}/${file}")
  endif()
  target_include_directories(mutant-${name} BEFORE PRIVATE "${folder}")
  target_compile_options(mutant-${name} PRIVATE -Wno-unused)
endfunction()

pico_mutant(no-reset-release hal/rp2040/chip.hpp
  "resets::kReset.clear(blocks);\n  resets::kResetDone.await(blocks);" "static_cast<void>(blocks);")
pico_mutant(no-peripheral-clock hal/rp2040/chip.hpp
  "clocks::kPeriCtrl.write(clocks::kPeriEnable)" "clocks::kPeriCtrl.write(0)")
pico_mutant(no-timer-tick hal/rp2040/chip.hpp
  "kCrystalMHz | watchdog::kTickEnable" "kCrystalMHz")
pico_mutant(wrong-pin-mux hal/rp2040/spi_device.hpp
  "connect<MosiPin>(io_bank0::spi)" "connect<MosiPin>(io_bank0::uart)")
pico_mutant(spi-not-enabled hal/rp2040/spi_device.hpp
  "spi0::kControl1.write(spi0::kEnable)" "spi0::kControl1.write(0)")
pico_mutant(no-spi-pause hal/rp2040/spi_device.hpp
  "    pause();\n" "" CHIP adis16470)
pico_mutant(no-fifo-wait hal/rp2040/uart.hpp
  "return (uart0::kFlags.read() & uart0::kTransmitFull) == 0;" "return true;")
pico_mutant(lost-wake-up hal/cortex_m/interrupts.hpp
  "  const InterruptLock lock;\n  if (!has_work())" "  if (!has_work())")
pico_mutant(flash-routine-in-flash hal/rp2040/flash_chip.cpp
  "[[gnu::section(\".ram_code\"), gnu::noinline]] std::uint8_t exchange" "[[gnu::noinline]] std::uint8_t exchange")
pico_mutant(interrupts-from-flash hal/rp2040/flash_chip.cpp
  "cortex_m::nvic::kClearEnable<nvic::io_bank0>.write(~bit(nvic::io_bank0));" "")
pico_mutant(no-write-enable hal/rp2040/flash_chip.cpp "exchange(kWriteEnable)" "exchange(kReadStatus)")

# No mistake: what the stack needs is proved for this image too, and reached by it (footprint.test.mjs).
pico_mutant(moving-average-published firmware/app/node_params.hpp
  "published = Predictor::kalman;" "published = Predictor::moving_average;")
