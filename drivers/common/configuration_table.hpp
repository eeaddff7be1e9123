/// @file
/// A chip's configuration as a table of bits to set and to clear, applied, read back, and verified
/// again one entry at a time for as long as the chip runs (the pattern of PX4's register drivers).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "drivers/common/driver_error.hpp"
#include "drivers/common/register_access.hpp"

namespace zerorate::drivers {

/// Bits of one register that must be one and that must be zero; the others keep their value.
struct ConfigurationEntry {
  std::uint8_t address;
  std::uint8_t set;
  std::uint8_t clear;

  [[nodiscard]] constexpr bool holds(std::uint8_t value) const {
    return (value & set) == set && (value & clear) == 0;
  }
  [[nodiscard]] constexpr std::uint8_t applied_to(std::uint8_t value) const {
    return static_cast<std::uint8_t>((value & ~clear) | set);
  }
};

/// The bits of `field` in a register become `value`; no other bit is touched.
template <std::uint8_t Address, Access Kind, std::uint8_t Reset>
[[nodiscard]] constexpr ConfigurationEntry configure(Register<Address, Kind, Reset> reg,
                                                     std::uint8_t field, std::uint8_t value) {
  static_assert(reg.is_readable && reg.is_writable,
                "only a read-write register can be configured and verified");
  return {Address, static_cast<std::uint8_t>(value & field),
          static_cast<std::uint8_t>(field & ~value)};
}

/// Entries with others behind the first one.
template <std::size_t N, std::size_t M>
[[nodiscard]] constexpr std::array<ConfigurationEntry, N + M> joined(
    const std::array<ConfigurationEntry, N>& entries,
    const std::array<ConfigurationEntry, M>& others) {
  std::array<ConfigurationEntry, N + M> all{entries[0]};
  std::copy(others.begin(), others.end(), all.begin() + 1);
  std::copy(entries.begin() + 1, entries.end(), all.begin() + 1 + M);
  return all;
}

/// Entries with others behind the last one.
template <std::size_t N, std::size_t M>
[[nodiscard]] constexpr std::array<ConfigurationEntry, N + M> followed_by(
    const std::array<ConfigurationEntry, N>& entries,
    const std::array<ConfigurationEntry, M>& others) {
  std::array<ConfigurationEntry, N + M> all{};
  std::copy(entries.begin(), entries.end(), all.begin());
  std::copy(others.begin(), others.end(), all.begin() + N);
  return all;
}

/// N entries, applied in the order of the table: switch the sensor on in the last one.
template <std::size_t N>
class ConfigurationTable {
 public:
  constexpr explicit ConfigurationTable(const std::array<ConfigurationEntry, N>& entries)
      : entries_(entries) {}

  /// Writes every entry and reads it back. Cost: three transactions an entry. Stops at the first
  /// error: bus_failed, or configuration_lost if a register does not take its value.
  template <RegisterBus Bus>
  core::Result<void, DriverError> apply(Bus& bus) {
    return apply(bus, 0, N);
  }
  /// Entries from `first` to before `end` alone.
  template <RegisterBus Bus>
  core::Result<void, DriverError> apply(Bus& bus, std::size_t first, std::size_t end) {
    for (const ConfigurationEntry& entry : std::span{entries_}.subspan(first, end - first)) {
      const auto before = read(bus, entry);
      if (!before) return core::Unexpected{before.error()};
      if (const auto done = bus.write(entry.address, entry.applied_to(*before)); !done) {
        return bus_failed(done.error(), entry.address);
      }
      if (const auto held = verify(bus, entry); !held) return held;
    }
    next_ = 0;
    return {};
  }

  /// Reads the next entry's register and compares; one transaction. After N calls every entry was
  /// seen. An error does not move on: the next call looks at the same entry again.
  template <RegisterBus Bus>
  core::Result<void, DriverError> verify_next(Bus& bus) {
    if (const auto held = verify(bus, entries_[next_]); !held) return held;
    next_ = (next_ + 1) % N;
    return {};
  }

  [[nodiscard]] static constexpr std::size_t size() { return N; }

 private:
  template <RegisterBus Bus>
  static core::Result<std::uint8_t, DriverError> read(Bus& bus, const ConfigurationEntry& entry) {
    std::array<std::uint8_t, 1> value{};
    if (const auto done = bus.read(entry.address, value); !done) {
      return bus_failed(done.error(), entry.address);
    }
    return value[0];
  }

  template <RegisterBus Bus>
  static core::Result<void, DriverError> verify(Bus& bus, const ConfigurationEntry& entry) {
    const auto value = read(bus, entry);
    if (!value) return core::Unexpected{value.error()};
    if (!entry.holds(*value)) return refused(DriverErrorCode::configuration_lost, entry.address);
    return {};
  }

  std::array<ConfigurationEntry, N> entries_;
  std::size_t next_ = 0;
};

}  // namespace zerorate::drivers
