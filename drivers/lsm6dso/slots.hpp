/// @file
/// Words of gyro and accelerometer that the FIFO of the LSM6DSO and its relatives holds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "drivers/common/acceleration.hpp"
#include "drivers/common/gyro_source.hpp"

namespace zerorate::drivers::lsm6dso {

/// Joins the words of each time slot to a sample, in whatever order the chip writes them. A gyro's
/// word whose partner is lost makes a sample without acceleration, which comes with the next word;
/// an accelerometer's word alone makes none.
class Slots {
 public:
  using Raw = std::array<std::int16_t, 3>;

  constexpr explicit Slots(const AccelerationScale& scale) : scale_(scale) {}

  /// Forgets the words that wait for their partner.
  constexpr void restart() {
    gyro_.reset();
    acceleration_.reset();
  }

  /// @param slot TAG_CNT
  /// @return whether out is a sample: that of this slot, or the one before
  constexpr bool add_gyro(std::uint8_t slot, const GyroSample& gyro, GyroSample& out) {
    if (acceleration_ && acceleration_->slot == slot) {
      out = gyro;
      set_acceleration(out, acceleration_->raw, scale_);
      acceleration_.reset();
      return true;
    }
    acceleration_.reset();
    const bool is_sample = gyro_.has_value();
    if (is_sample) out = gyro_->sample;
    gyro_ = Gyro{gyro, slot};
    return is_sample;
  }

  /// @return whether out is a sample
  constexpr bool add_acceleration(std::uint8_t slot, const Raw& raw, GyroSample& out) {
    if (!gyro_) {
      acceleration_ = Acceleration{raw, slot};
      return false;
    }
    out = gyro_->sample;
    if (gyro_->slot == slot) {
      set_acceleration(out, raw, scale_);
    } else {
      acceleration_ = Acceleration{raw, slot};
    }
    gyro_.reset();
    return true;
  }

  /// Samples of the gyro that are still to come, from those words and the one that waits here.
  [[nodiscard]] constexpr std::size_t samples_to_come(std::size_t words) const {
    return (words + (gyro_ ? 1 : 0) + 1) / 2;
  }

  [[nodiscard]] constexpr const AccelerationScale& scale() const { return scale_; }

 private:
  struct Gyro {
    GyroSample sample;
    std::uint8_t slot;
  };
  struct Acceleration {
    Raw raw;
    std::uint8_t slot;
  };

  AccelerationScale scale_;
  std::optional<Gyro> gyro_;
  std::optional<Acceleration> acceleration_;
};

}  // namespace zerorate::drivers::lsm6dso
