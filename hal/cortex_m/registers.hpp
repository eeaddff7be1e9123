/// @file
/// Registers as types, so that a wrong access does not compile; and the registers that every
/// Cortex-M has. Sections are those of the Armv7-M Architecture Reference Manual (Arm, DDI 0403).
#pragma once

#include <cstdint>

namespace zerorate::hal::cortex_m {

[[nodiscard]] constexpr std::uint32_t bit(unsigned index) {
  return std::uint32_t{1} << index;
}

enum class Access : std::uint8_t { read_only, write_only, read_write };

/// One 32-bit register. An empty type: an access is one load or store, and never a call, which code
/// in RAM could not make while the flash is away.
template <std::uint32_t Address, Access Kind = Access::read_write>
class Register {
 public:
  [[gnu::always_inline]] [[nodiscard]] static std::uint32_t read() requires(Kind !=
                                                                            Access::write_only) {
    return word();
  }
  [[gnu::always_inline]] static void write(std::uint32_t value) requires(Kind !=
                                                                         Access::read_only) {
    word() = value;
  }
  /// Some registers act when they are read, whatever the value.
  static void touch() requires(Kind != Access::write_only) {
    [[maybe_unused]] const std::uint32_t ignored = read();
  }
  /// Blocks until all of these bits are ones. Only for what the hardware always does.
  static void await(std::uint32_t bits) requires(Kind != Access::write_only) {
    while ((read() & bits) != bits) {
    }
  }

 private:
  [[gnu::always_inline]] static volatile std::uint32_t& word() {
    // The address is the hardware's.
    // NOLINTNEXTLINE(performance-no-int-to-ptr,cppcoreguidelines-pro-type-reinterpret-cast)
    return *reinterpret_cast<volatile std::uint32_t*>(std::uintptr_t{Address});
  }
};

template <std::uint32_t Address>
using ReadOnly = Register<Address, Access::read_only>;
template <std::uint32_t Address>
using WriteOnly = Register<Address, Access::write_only>;

/// B3.4: the interrupt controller; the registers that hold an interrupt's bit or byte.
namespace nvic {
template <unsigned Interrupt>
inline constexpr Register<0xE000'E100 + 4 * (Interrupt / 32)> kSetEnable;
template <unsigned Interrupt>
inline constexpr Register<0xE000'E180 + 4 * (Interrupt / 32)> kClearEnable;
template <unsigned Interrupt>
inline constexpr Register<0xE000'E200 + 4 * (Interrupt / 32)> kSetPending;
template <unsigned Interrupt>
inline constexpr Register<0xE000'E400 + 4 * (Interrupt / 4)> kPriority;
}  // namespace nvic

/// B3.2: system control.
namespace scb {
inline constexpr Register<0xE000'ED08> kVectorTable;
inline constexpr Register<0xE000'ED88> kCoprocessorAccess;
inline constexpr std::uint32_t kFloatingPoint = 0xFU << 20U;  // coprocessors 10 and 11, full access
}  // namespace scb

/// B3.3: the processor's own timer.
namespace systick {
inline constexpr Register<0xE000'E010> kControl;
inline constexpr Register<0xE000'E014> kReload;
inline constexpr Register<0xE000'E018> kCurrent;
inline constexpr std::uint32_t kEnable = bit(0);
inline constexpr std::uint32_t kInterrupt = bit(1);
inline constexpr std::uint32_t kProcessorClock = bit(2);
}  // namespace systick

}  // namespace zerorate::hal::cortex_m
