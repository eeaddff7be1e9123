/// @file
/// Two banks of registers behind one bus of eight address bits.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "drivers/common/register_access.hpp"
#include "drivers/icm20948/registers.hpp"

namespace zerorate::drivers::icm20948 {

/// A RegisterBus over another one: bit 7 of an address is bank 2 (registers.hpp). The chip is left
/// in bank 0, so that whoever else asks for its identity finds it. One transaction for a register
/// of bank 0, three for one of bank 2, and one more after a selection that failed.
template <RegisterBus Bus>
class BankedRegisters {
 public:
  constexpr explicit BankedRegisters(Bus bus) : bus_(bus) {}

  // Not inlined: a driver has many calls, and a board counts bytes.
  [[gnu::noinline]] core::Result<void, hal::BusError> read(std::uint8_t first,
                                                           std::span<std::uint8_t> out) {
    return in_bank_of(first, [&] { return bus_.read(in_bank(first), out); });
  }
  [[gnu::noinline]] core::Result<void, hal::BusError> write(std::uint8_t address,
                                                            std::uint8_t value) {
    return in_bank_of(address, [&] { return bus_.write(in_bank(address), value); });
  }

 private:
  static constexpr std::uint8_t in_bank(std::uint8_t address) {
    return static_cast<std::uint8_t>(address & ~kBank2);
  }

  template <class Access>
  core::Result<void, hal::BusError> in_bank_of(std::uint8_t address, Access access) {
    const bool is_bank_2 = (address & kBank2) != 0;
    if (is_bank_2) {
      if (const auto done = select(bits::kRegBankSelBank2); !done) return done;
    } else if (is_elsewhere_) {
      if (const auto done = select(0); !done) return done;
    }
    const auto done = access();
    if (!is_bank_2) return done;
    const auto back = select(0);
    return done ? back : done;
  }

  [[gnu::noinline]] core::Result<void, hal::BusError> select(std::uint8_t bank) {
    is_elsewhere_ = true;
    const auto done = bus_.write(kRegBankSel.address, bank);
    if (done) is_elsewhere_ = bank != 0;
    return done;
  }

  Bus bus_;
  bool is_elsewhere_ = false;  ///< the chip is, or may be, in another bank than 0
};

}  // namespace zerorate::drivers::icm20948
