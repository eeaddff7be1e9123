/// @file
/// The accelerometer in a gyro's chip, for drivers that read it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/base/units.hpp"
#include "drivers/common/gyro_source.hpp"

namespace zerorate::drivers {

/// Whether a driver reads the accelerometer beside the gyro. Part of the driver's type: an image
/// with `off` has no code and no memory for it.
enum class Accelerometer : std::uint8_t { off, on };

/// A driver, or a choice of drivers, whose samples can have the acceleration.
template <class Gyro>
concept MeasuresAcceleration = Gyro::kHasAccelerometer;

/// Stands for a member that a driver without an accelerometer does not have.
struct NoMember {};

/// `Member` in a driver that reads the accelerometer; nothing in any other, where it is declared
/// [[no_unique_address]].
template <Accelerometer kAccelerometer, class Member>
using MemberWith = std::conditional_t<kAccelerometer == Accelerometer::on, Member, NoMember>;

/// Counts of an accelerometer and their meaning.
struct AccelerationScale {
  core::Acceleration lsb;  ///< specific force of one count
  std::int16_t highest_raw = 32767;
  std::int16_t lowest_raw = -32768;
};

/// Sets the acceleration of a sample, unless an axis is at the end of its range or beyond: what
/// acted on it is then unknown, and the sample has no acceleration.
constexpr void set_acceleration(GyroSample& sample, const std::array<std::int16_t, 3>& raw,
                                const AccelerationScale& scale) {
  sample.has_acceleration = true;
  for (std::size_t axis = 0; axis < raw.size(); ++axis) {
    sample.acceleration[axis] = scale.lsb * static_cast<float>(raw[axis]);
    const bool is_inside = raw[axis] < scale.highest_raw && raw[axis] > scale.lowest_raw;
    sample.has_acceleration = sample.has_acceleration && is_inside;
  }
}

}  // namespace zerorate::drivers
