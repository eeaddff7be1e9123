/// @file
/// Conversion of counts that every three-axis gyro needs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/units.hpp"
#include "drivers/common/gyro_source.hpp"

namespace zerorate::drivers {

/// Sets the rates and the saturated axes of a sample. One multiplication an axis, so that raw 0 is
/// exactly 0.
/// @param lsb the rate of one count
/// @param full_scale_raw an axis is saturated at or beyond plus or minus so many counts
constexpr void set_rates(GyroSample& sample, const std::array<std::int16_t, 3>& raw,
                         core::AngularRate lsb, std::int16_t full_scale_raw) {
  sample.saturated_axes = 0;
  for (std::size_t axis = 0; axis < raw.size(); ++axis) {
    sample.rate[axis] = lsb * static_cast<float>(raw[axis]);
    if (raw[axis] >= full_scale_raw || raw[axis] <= -full_scale_raw) {
      sample.saturated_axes |= static_cast<std::uint8_t>(1U << axis);
    }
  }
}

/// Two's complement from its low and its high byte, in whatever order the chip sends them.
[[nodiscard]] constexpr std::int16_t decode_int16(std::uint8_t low, std::uint8_t high) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(low | (high << 8U)));
}

}  // namespace zerorate::drivers
