// From the vector table to main(): RP2040 datasheet, 2.3.2 (interrupt numbers).

#include <array>
#include <cstdint>

#include "hal/cortex_m/registers.hpp"
#include "hal/cortex_m/startup.hpp"
#include "hal/rp2040/registers.hpp"

using namespace zerorate::hal;
using rp2040::nvic::io_bank0;
using rp2040::nvic::timer_0;
using rp2040::nvic::uart0;

extern "C" {
void handle_timer_0();
void handle_io_bank0();
void handle_uart0();

[[noreturn]] void start() {
  cortex_m::prepare_memory();
  // The address is the hardware's.
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast)
  cortex_m::scb::kVectorTable.write(
      reinterpret_cast<std::uintptr_t>(data_start));  // vectors_in_ram
  main();
  fault();
}
}

namespace {

struct BootVectors {
  const std::uint32_t* stack;
  std::array<cortex_m::Handler, 3> exceptions;
};

using Vectors = cortex_m::Vectors<uart0 + 1>;

constexpr Vectors make_vectors() {
  Vectors table = cortex_m::reset_vectors<uart0 + 1>(start);
  table.interrupts[timer_0] = handle_timer_0;
  table.interrupts[io_bank0] = handle_io_bank0;
  table.interrupts[uart0] = handle_uart0;
  return table;
}

}  // namespace

// Read by boot2, which knows it by its name: enough to reach start() or fault().
extern "C" [[gnu::section(".vectors"), gnu::used]] const constinit BootVectors vectors{
    stack_top, {start, fault, fault}};

// Read by the processor from start() on, also while the flash is no memory; a variable, so that it
// stands in RAM (pico.ld.in).
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables)
[[gnu::section(".vectors_in_ram"), gnu::used]] constinit Vectors vectors_in_ram = make_vectors();
