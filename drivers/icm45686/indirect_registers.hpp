/// @file
/// Registers behind a window of two addresses and a value, on one bus of eight address bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/assert.hpp"
#include "core/base/result.hpp"
#include "drivers/common/register_access.hpp"
#include "drivers/icm45686/registers.hpp"

namespace zerorate::drivers::icm45686 {

/// A RegisterBus over another one: bit 7 of an address is a register behind the window
/// (registers.hpp), one a call. The chip takes up to 4 us for each step and shows its end in
/// IREG_DONE. One transaction for a register of its own; for one behind the window four or more to
/// read and two or more to write. A chip that is never done gives BusError::timeout.
template <BurstBus Bus>
class IndirectRegisters {
 public:
  constexpr explicit IndirectRegisters(Bus bus) : bus_(bus) {}

  // Not inlined: a driver has many calls, and a board counts bytes.
  [[gnu::noinline]] core::Result<void, hal::BusError> read(std::uint8_t first,
                                                           std::span<std::uint8_t> out) {
    if ((first & kIndirect) == 0) return bus_.read(first, out);
    ZERORATE_ASSERT(out.size() == 1);
    const std::uint16_t address = address_of(first);
    const std::array<std::uint8_t, 2> window{high(address), low(address)};
    if (const auto done = wait(); !done) return done;
    if (const auto done = bus_.write(kIregAddr.address, window); !done) return done;
    if (const auto done = wait(); !done) return done;
    return bus_.read(kIregData.address, out);
  }
  [[gnu::noinline]] core::Result<void, hal::BusError> write(std::uint8_t address,
                                                            std::uint8_t value) {
    if ((address & kIndirect) == 0) return bus_.write(address, value);
    // Address and value in one transaction: an address alone makes the chip fetch the register.
    const std::uint16_t behind = address_of(address);
    const std::array<std::uint8_t, 3> window{high(behind), low(behind), value};
    if (const auto done = wait(); !done) return done;
    return bus_.write(kIregAddr.address, window);
  }

 private:
  static constexpr std::uint16_t address_of(std::uint8_t address) {
    const std::size_t index = address & ~unsigned{kIndirect};
    ZERORATE_ASSERT(index < kIregAddresses.size());
    return kIregAddresses[index];
  }
  static constexpr std::uint8_t high(std::uint16_t address) {
    return static_cast<std::uint8_t>(address >> 8U);
  }
  static constexpr std::uint8_t low(std::uint16_t address) {
    return static_cast<std::uint8_t>(address & 0xFFU);
  }

  /// Asks until the step before is done: 16 questions take more than 10 us at 24 MHz.
  [[gnu::noinline]] core::Result<void, hal::BusError> wait() {
    constexpr int kMostQuestions = 16;
    std::array<std::uint8_t, 1> misc{};
    for (int i = 0; i < kMostQuestions; ++i) {
      if (const auto done = bus_.read(kRegMisc2.address, misc); !done) return done;
      if ((misc[0] & bits::kRegMisc2IregDone) != 0) return {};
    }
    return core::Unexpected{hal::BusError::timeout};
  }

  Bus bus_;
};

}  // namespace zerorate::drivers::icm45686
