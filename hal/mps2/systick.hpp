/// @file
/// The processor's own timer (ARMv7-M Architecture Reference Manual, B3.3).
#pragma once

#include <cstdint>

namespace zerorate::hal::mps2 {

/// Counts periods of the processor's clock, 24 bits. Where QEMU runs with a fixed time an
/// instruction (-icount), a difference of counts is a number of instructions.
class SysTick {
 public:
  static constexpr std::uint32_t kMask = 0x00FF'FFFF;

  static void start() {
    at(kReload) = kMask;
    at(kCurrent) = 0;
    at(kControl) = kEnabled | kProcessorClock;
  }
  /// Periods from an earlier count to now, up to kMask.
  [[nodiscard]] static std::uint32_t since(std::uint32_t count) {
    return (count - at(kCurrent)) & kMask;  // it counts down
  }
  [[nodiscard]] static std::uint32_t count() { return at(kCurrent); }

 private:
  static constexpr std::uintptr_t kControl = 0xE000'E010;
  static constexpr std::uintptr_t kReload = 0xE000'E014;
  static constexpr std::uintptr_t kCurrent = 0xE000'E018;
  static constexpr std::uint32_t kEnabled = 1;
  static constexpr std::uint32_t kProcessorClock = 4;

  static volatile std::uint32_t& at(std::uintptr_t address) {
    // The address is the processor's.
    // NOLINTNEXTLINE(performance-no-int-to-ptr,cppcoreguidelines-pro-type-reinterpret-cast)
    return *reinterpret_cast<volatile std::uint32_t*>(address);
  }
};

}  // namespace zerorate::hal::mps2
