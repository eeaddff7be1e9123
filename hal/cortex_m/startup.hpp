/// @file
/// From the vector table to main() (Armv6-M and Armv7-M Architecture Reference Manuals, B1.5), for
/// the startup file of a board alone. That file is compiled with
/// -fno-tree-loop-distribute-patterns: what it copies and fills must not become calls of functions
/// that may not be trusted to run yet.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

// Symbols of the linker script: their addresses are what counts.
// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables)
extern "C" {
extern std::uint32_t stack_top[];
extern std::uint32_t data_start[];
extern std::uint32_t data_end[];
extern const std::uint32_t data_load[];
extern std::uint32_t bss_start[];
extern std::uint32_t bss_end[];

int main();

/// Whatever nobody expects, a failed assertion among it: the watchdog starts the node again.
[[noreturn]] inline void fault() {
  for (;;) {
    asm volatile("" ::: "memory");
  }
}
}
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

namespace zerorate::hal::cortex_m {

using Handler = void (*)();

/// Gives variables their first values.
inline void prepare_memory() {
  std::copy_n(static_cast<const std::uint32_t*>(data_load), data_end - data_start,
              static_cast<std::uint32_t*>(data_start));
  std::fill(static_cast<std::uint32_t*>(bss_start), static_cast<std::uint32_t*>(bss_end), 0U);
}

/// @tparam Interrupts of the chip, up to the last one that the board enables
template <std::size_t Interrupts>
struct Vectors {
  const std::uint32_t* stack;
  std::array<Handler, 15> exceptions;
  std::array<Handler, Interrupts> interrupts;
};

/// A table with nothing but the reset; the board adds its interrupts.
template <std::size_t Interrupts>
[[nodiscard]] constexpr Vectors<Interrupts> reset_vectors(Handler start) {
  Vectors<Interrupts> table{.stack = stack_top, .exceptions = {}, .interrupts = {}};
  table.exceptions.fill(fault);
  table.exceptions[0] = start;
  table.interrupts.fill(fault);
  return table;
}

}  // namespace zerorate::hal::cortex_m
