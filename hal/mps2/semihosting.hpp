/// @file
/// How a program under test talks to the emulator that runs it (Arm, Semihosting for AArch32 and
/// AArch64, sections 5.4 and 6). For tests only: on a real processor without a debugger it faults.
#pragma once

#include <array>
#include <cstdint>

/// In semihosting.S: the operation and its parameter stand where the call wants them.
extern "C" std::uint32_t zerorate_semihosting(std::uint32_t operation, const void* parameter);

namespace zerorate::hal::mps2 {

class Semihosting {
 public:
  /// @param text ends with a zero
  static void write(const char* text) { (void)call(kWrite0, text); }

  [[noreturn]] static void exit(std::uint32_t code) {
    constexpr std::uint32_t kApplicationExit = 0x20026;
    const std::array<std::uint32_t, 2> block{kApplicationExit, code};
    for (;;) (void)call(kExitExtended, block.data());
  }

 private:
  static constexpr std::uint32_t kWrite0 = 0x04;
  static constexpr std::uint32_t kExitExtended = 0x20;

  static std::uint32_t call(std::uint32_t operation, const void* parameter) {
    return zerorate_semihosting(operation, parameter);
  }
};

}  // namespace zerorate::hal::mps2
