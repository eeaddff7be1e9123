/// @file
/// Columns of a recording, and one row of them in SI units.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string_view>

#include "host_tools/lib/recording/findings.hpp"

namespace zerorate::recording {

inline constexpr std::size_t kMaxAxes = 3;
inline constexpr std::size_t kMaxWheels = 4;

inline constexpr std::array<float, kMaxAxes> kNoAcceleration = {
    std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::quiet_NaN(),
    std::numeric_limits<float>::quiet_NaN()};

/// The unit in which Writer writes rates. In a Row they are always rad/s.
enum class RateUnit : std::uint8_t { deg_per_s, rad_per_s };

/// Factor from a unit of the file to rad/s.
[[nodiscard]] constexpr double rad_per_s_in(RateUnit unit) {
  return unit == RateUnit::deg_per_s ? std::numbers::pi / 180.0 : 1.0;
}

/// A number of the file in SI units: converted in double precision and rounded once.
[[nodiscard]] inline float to_si(double number, double si_per_unit) {
  return static_cast<float>(number * si_per_unit);
}

/// Columns of a recording, besides the time.
struct Columns {
  std::size_t axis_count = kMaxAxes;  ///< 3 (gx, gy, gz) or 1 (rate)
  RateUnit rate_unit = RateUnit::deg_per_s;
  bool temperature = false;
  bool odometer = false;
  bool still = false;
  bool ref_heading = false;  ///< column of a reference system, like ref_rate and ref_speed
  bool ref_rate = false;
  bool ref_speed = false;
  bool speed = false;  ///< speed of the vehicle's own odometer; WithMotion makes the others of it
  bool acceleration = false;      ///< ax, ay and az
  bool is_timed_by_rows = false;  ///< the user gave the rate of the rows, stamps do not count
  bool are_increments = false;    ///< the rates of the rows are angles since the row before [rad]
  std::string_view program = {};  ///< program that wrote the file, where it was recognised

  bool operator==(const Columns&) const = default;
};

/// One sample of a recording. Members without a column keep the value given here.
struct Row {
  std::int64_t time_ns = 0;                     ///< the file's clock, exact
  std::array<float, kMaxAxes> rate_rad_s = {};  ///< the first Columns::axis_count are used
  float temperature_degc = std::numeric_limits<float>::quiet_NaN();
  std::int64_t odometer_pulses = 0;  ///< counted since some moment before the recording
  bool still = false;
  float speed_m_s = std::numeric_limits<float>::quiet_NaN();  ///< speed by the vehicle's odometer
  float turn_rad_s = 0.0F;  ///< rate of turn by the vehicle's odometer, not by the gyro
  /// Heading by a reference system, of any origin and sign, wrapped or not. Single precision
  /// resolves 0.0000003 of its size: a wrapped heading to 0.00003 deg.
  float ref_heading_rad = std::numeric_limits<float>::quiet_NaN();
  float ref_rate_rad_s = std::numeric_limits<float>::quiet_NaN();  ///< about the vertical
  float ref_speed_m_s = std::numeric_limits<float>::quiet_NaN();
  /// Specific force along x, y, z: 1 g upwards at rest; NaN where it was not measured.
  std::array<float, kMaxAxes> acceleration_m_s2 = kNoAcceleration;
  FindingSet findings;  ///< oddities of this row; set by the reader, ignored by the writer

  /// True if the acceleration was measured along all axes.
  [[nodiscard]] bool has_acceleration() const {
    return std::ranges::all_of(acceleration_m_s2, [](float along) { return std::isfinite(along); });
  }
};

}  // namespace zerorate::recording
