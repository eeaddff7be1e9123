// From the vector table to main(): RM0090, 12.1 (interrupt numbers); Armv7-M Architecture Reference
// Manual, B1.5 (vector table, reset).

#include <algorithm>
#include <array>
#include <cstdint>

#include "hal/stm32f4/registers.hpp"

using namespace zerorate::hal::stm32f4;

// Symbols of stm32f405.ld: their addresses are what counts.
// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables)
extern "C" {
extern std::uint32_t stack_top[];
extern std::uint32_t data_start[];
extern std::uint32_t data_end[];
extern const std::uint32_t data_load[];
extern std::uint32_t bss_start[];
extern std::uint32_t bss_end[];

int main();
void handle_exti0();
void handle_exti1();
void handle_timer_2();
void handle_usart_2();

/// Whatever nobody expects, a failed assertion among it: the watchdog starts the node again.
[[noreturn]] void fault() {
  for (;;) {
    asm volatile("" ::: "memory");
  }
}

[[noreturn]] void start() {
  constexpr std::uint32_t kFullAccess = 0xFU
                                        << 20U;  // coprocessors 10 and 11: the floating-point unit
  nvic::kCoprocessorAccess.write(kFullAccess);
  asm volatile("dsb\n isb" ::: "memory");
  std::copy_n(static_cast<const std::uint32_t*>(data_load), data_end - data_start,
              static_cast<std::uint32_t*>(data_start));
  std::fill(static_cast<std::uint32_t*>(bss_start), static_cast<std::uint32_t*>(bss_end), 0U);
  main();
  fault();
}
}
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

namespace {

using Handler = void (*)();

/// Vectors up to usart_2, the last interrupt that this board enables.
struct Vectors {
  const std::uint32_t* stack;
  std::array<Handler, 15> exceptions;
  std::array<Handler, nvic::usart_2 + 1> interrupts;
};

constexpr Vectors make_vectors() {
  Vectors table{.stack = stack_top};
  table.exceptions.fill(fault);
  table.exceptions[0] = start;
  table.interrupts.fill(fault);
  table.interrupts[nvic::exti0] = handle_exti0;
  table.interrupts[nvic::exti1] = handle_exti1;
  table.interrupts[nvic::timer_2] = handle_timer_2;
  table.interrupts[nvic::usart_2] = handle_usart_2;
  return table;
}

}  // namespace

extern "C" [[gnu::section(".vectors"), gnu::used]] const constinit Vectors vectors = make_vectors();
