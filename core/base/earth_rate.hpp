/// @file
/// Earth's rotation in the rates of a sensor at rest.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/units.hpp"

namespace zerorate::core {

/// Unit vector along the axes x, y, z of a sensor.
using Direction = std::array<float, 3>;

/// Axis of a sensor that points up, or down.
struct UpAxis {
  std::uint8_t axis = 2;  ///< 0, 1, 2: x, y, z
  bool points_down = false;

  [[nodiscard]] constexpr Direction direction() const {
    Direction up{};
    up[axis] = points_down ? -1.0F : 1.0F;
    return up;
  }
  constexpr bool operator==(const UpAxis&) const = default;
};

/// Shares of the Earth's rotation in the rates of a sensor; zero where the latitude is not known,
/// and the rotation stays in the bias (docs/reference/earth-rate.md).
struct EarthRate {
  std::array<float, 3> vertical_rad_s{};  ///< share of the vertical, taken out of the rates
  /// Variance of what the level part of an axis measures at another heading than that of the stop.
  std::array<float, 3> heading_variance_rad2_s2{};

  constexpr bool operator==(const EarthRate&) const = default;
  /// Shares for another direction of the vertical than an axis.
  /// @param axis the one that these shares are of
  [[nodiscard]] constexpr EarthRate about(UpAxis axis, const Direction& up) const {
    const float vertical = (axis.points_down ? -1.0F : 1.0F) * vertical_rad_s[axis.axis];
    const float level = heading_variance_rad2_s2[axis.axis == 0 ? 1 : 0];
    EarthRate earth;
    for (std::size_t i = 0; i < 3; ++i) {
      earth.vertical_rad_s[i] = vertical * up[i];
      earth.heading_variance_rad2_s2[i] = level * (1.0F - up[i] * up[i]);
    }
    return earth;
  }
  /// Shares where nothing is known of the vertical: all of the rotation stays in the bias.
  [[nodiscard]] constexpr EarthRate about_any(UpAxis axis) const {
    const float vertical = vertical_rad_s[axis.axis];
    const float all = vertical * vertical + heading_variance_rad2_s2[axis.axis == 0 ? 1 : 0];
    return {.vertical_rad_s = {}, .heading_variance_rad2_s2 = {all, all, all}};
  }
};

/// Earth's rotation at a latitude. An axis that points up measures W sin(latitude), with
/// W = 7.292115e-5 rad/s (WGS 84) and northern latitudes positive. A level axis measures
/// W cos(latitude) cos(heading); between two unrelated headings the difference has the variance
/// (W cos(latitude))^2.
/// Relative error below 1e-5.
/// @param latitude_deg from -90 to 90
[[nodiscard]] constexpr EarthRate earth_rate(float latitude_deg, UpAxis up) {
  constexpr float kRotation_rad_s = 7.292115e-5F;
  const float x = deg(latitude_deg).in(rad);
  const float square = x * x;
  // Taylor's series to the ninth order: 4e-6 at the pole.
  const float sine =
      x * (1.0F - square / 6.0F *
                      (1.0F - square / 20.0F * (1.0F - square / 42.0F * (1.0F - square / 72.0F))));
  const float level_variance = kRotation_rad_s * kRotation_rad_s * (1.0F - sine * sine);
  EarthRate earth;
  for (std::size_t i = 0; i < 3; ++i) {
    if (i != up.axis) {
      earth.heading_variance_rad2_s2[i] = level_variance > 0.0F ? level_variance : 0.0F;
    } else {
      earth.vertical_rad_s[i] = (up.points_down ? -kRotation_rad_s : kRotation_rad_s) * sine;
    }
  }
  return earth;
}

/// Shares of a node whose vertical is given.
struct GivenEarth {
  [[nodiscard]] static constexpr const EarthRate& shares(const EarthRate& given) { return given; }
};
/// Shares of a node that measures the vertical.
struct MeasuredEarth {
  EarthRate measured;

  [[nodiscard]] constexpr const EarthRate& shares(const EarthRate& /*given*/) const {
    return measured;
  }
};

}  // namespace zerorate::core
