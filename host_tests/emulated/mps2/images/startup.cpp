// From the vector table to main() on a board of QEMU, which has loaded code and variables where the
// linker put them.

#include <array>
#include <cstdint>

#include "hal/cortex_m/registers.hpp"
#include "hal/mps2/semihosting.hpp"

// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables): a symbol of the linker script
extern "C" {
extern std::uint32_t stack_top[];
int main();

/// An exception, a failed assertion among them: the test sees the exit code.
[[noreturn]] void fault() {
  zerorate::hal::mps2::Semihosting::write("fault\n");
  zerorate::hal::mps2::Semihosting::exit(99);
}

/// An image that uses SysTick has its own.
[[gnu::weak]] void handle_systick() {
  fault();
}

/// Not a place for floating point: its unit is off.
[[noreturn]] void start() {
#ifdef __ARM_FP
  using namespace zerorate::hal::cortex_m::scb;
  kCoprocessorAccess.write(kFloatingPoint);
  asm volatile("dsb\n isb" ::: "memory");
#endif
  zerorate::hal::mps2::Semihosting::exit(static_cast<std::uint32_t>(main()));
}
}
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

namespace {

using Handler = void (*)();
struct Vectors {
  const std::uint32_t* stack;
  std::array<Handler, 15> exceptions;
};
constexpr Vectors make_vectors() {
  Vectors table{.stack = stack_top};
  table.exceptions.fill(fault);
  table.exceptions[0] = start;
  table.exceptions[14] = handle_systick;
  return table;
}

}  // namespace

extern "C" [[gnu::section(".vectors"), gnu::used]] const constinit Vectors vectors = make_vectors();
