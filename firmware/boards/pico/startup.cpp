// From the vector table to main(): RP2040 datasheet, 2.3.2 (interrupt numbers); ARMv6-M
// Architecture Reference Manual, B1.5 (vector table, reset).

#include <algorithm>
#include <array>
#include <cstdint>

// Symbols of pico.ld: their addresses are what counts.
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
  main();
  fault();
}
}
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

namespace {

using Handler = void (*)();

struct Vectors {
  const std::uint32_t* stack;
  std::array<Handler, 15> exceptions;
  std::array<Handler, 32> interrupts;
};

constexpr Vectors make_vectors() {
  Vectors table{.stack = stack_top};
  table.exceptions.fill(fault);
  table.exceptions[0] = start;
  table.interrupts.fill(fault);
  table.interrupts[0] = handle_timer_0;
  table.interrupts[13] = handle_io_bank0;
  table.interrupts[20] = handle_uart0;
  return table;
}

}  // namespace

// Read by the processor and by boot2, which know it by its place and its name.
extern "C" [[gnu::section(".vectors"), gnu::used]] const constinit Vectors vectors = make_vectors();
