// From the vector table to main(): RP2040 datasheet, 2.3.2 (interrupt numbers); ARMv6-M
// Architecture Reference Manual, B1.5 (vector table, reset).

#include <algorithm>
#include <array>
#include <cstdint>

#include "hal/rp2040/registers.hpp"

using namespace zerorate::hal::rp2040;

// Symbols of pico.ld.in: their addresses are what counts.
// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables)
extern "C" {
extern std::uint32_t stack_top[];
extern std::uint32_t data_start[];
extern std::uint32_t data_end[];
extern const std::uint32_t data_load[];
extern std::uint32_t bss_start[];
extern std::uint32_t bss_end[];

int main();
void handle_timer_0();
void handle_io_bank0();
void handle_uart0();

/// Whatever nobody expects, a failed assertion among it: the watchdog starts the node again.
[[noreturn]] void fault() {
  for (;;) {
    asm volatile("" ::: "memory");
  }
}

[[noreturn]] void start() {
  std::copy_n(static_cast<const std::uint32_t*>(data_load), data_end - data_start,
              static_cast<std::uint32_t*>(data_start));
  std::fill(static_cast<std::uint32_t*>(bss_start), static_cast<std::uint32_t*>(bss_end), 0U);
  // The address is the hardware's.
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast)
  scb::kVectorTable.write(reinterpret_cast<std::uintptr_t>(data_start));  // vectors_in_ram
  main();
  fault();
}
}
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

namespace {

using Handler = void (*)();

struct BootVectors {
  const std::uint32_t* stack;
  std::array<Handler, 3> exceptions;
};

/// Vectors up to uart0, the last interrupt that this board enables.
struct Vectors {
  const std::uint32_t* stack;
  std::array<Handler, 15> exceptions;
  std::array<Handler, nvic::uart0 + 1> interrupts;
};

constexpr Vectors make_vectors() {
  Vectors table{.stack = stack_top};
  table.exceptions.fill(fault);
  table.exceptions[0] = start;
  table.interrupts.fill(fault);
  table.interrupts[nvic::timer_0] = handle_timer_0;
  table.interrupts[nvic::io_bank0] = handle_io_bank0;
  table.interrupts[nvic::uart0] = handle_uart0;
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
