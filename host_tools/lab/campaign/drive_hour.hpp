/// @file
/// Hours of drives in streets, made with errors that rest does not show.
#pragma once

#include <array>
#include <cstdint>

#include "host_tools/lib/simulate/scenario.hpp"
#include "host_tools/lib/simulate/streets.hpp"
#include "host_tools/lib/simulate/vehicle.hpp"

namespace zerorate::campaign {

struct HourOptions {
  simulate::MotionErrors errors{};
  std::array<double, 3> per_g_rad_s{};  ///< sensitivity of z to the force along each axis
  /// Grades of 3 %: those of 10 % take 0.5 % off a turn about z.
  simulate::StreetParams streets{.duration_s = 3600.0,
                                 .mean_stop_s = 40.0,
                                 .manoeuvres_per_drive = 5.0,
                                 .least_grade = 0.03,
                                 .most_grade = 0.03};
};

struct Hour {
  simulate::VehicleMotion motion;
  simulate::ScenarioDrive drive;
};

/// Rows at 25 Hz with accelerations and an exact reference.
[[nodiscard]] Hour make_hour(std::uint64_t seed, const HourOptions& options);

}  // namespace zerorate::campaign
