/// @file
/// Loading of the file that a BMI270 needs at each start.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "drivers/bmi270/codec.hpp"
#include "drivers/bmi270/registers.hpp"
#include "drivers/common/driver_error.hpp"
#include "drivers/common/register_access.hpp"

namespace zerorate::drivers::bmi270 {

/// Writes the file in portions, so that no call of start() takes long: over I2C at 400 kHz one
/// takes 7 ms. The bytes must outlive it.
class ConfigFileLoader {
 public:
  constexpr explicit ConfigFileLoader(std::span<const std::uint8_t> file) : file_(file) {}

  [[nodiscard]] constexpr bool is_possible() const { return is_config_file_size(file_.size()); }
  constexpr void restart() { loaded_ = 0; }
  [[nodiscard]] constexpr bool is_done() const { return loaded_ == file_.size(); }

  /// Writes up to 256 bytes; twelve transactions.
  template <BurstBus Bus>
  core::Result<void, DriverError> load_portion(Bus& bus) {
    constexpr int kBursts = 4;
    for (int i = 0; i < kBursts && !is_done(); ++i) {
      if (const auto done = load_burst(bus); !done) return done;
    }
    return {};
  }

 private:
  template <BurstBus Bus>
  core::Result<void, DriverError> load_burst(Bus& bus) {
    const InitAddress address = encode_init_address(loaded_);
    const std::size_t size = std::min(BurstCommand::kMostBurst, file_.size() - loaded_);
    if (const auto done = write_register(bus, kInitAddr0, address.low); !done) return done;
    if (const auto done = write_register(bus, kInitAddr1, address.high); !done) return done;
    const auto done = bus.write(kInitData.address, file_.subspan(loaded_, size));
    if (!done) return bus_failed(done.error(), kInitData.address);
    loaded_ += size;
    return {};
  }

  std::span<const std::uint8_t> file_;
  std::size_t loaded_ = 0;
};

}  // namespace zerorate::drivers::bmi270
