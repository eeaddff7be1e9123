#include "host_tools/lib/simulate/legs.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "host_tools/lib/units/units.hpp"

namespace zerorate::simulate {

VehicleMotion follow(std::span<const Leg> legs, double sample_period_s, double metres_per_pulse) {
  using units::kRadPerDeg;
  VehicleMotion motion{
      .sample_period_s = sample_period_s, .rate_rad_s = {}, .speed_m_s = {}, .odometer_pulses = {}};
  Leg before = legs.front();
  double distance_m = 0.0;
  double start_s = 0.0;
  for (const Leg& leg : legs) {
    for (;;) {
      const double t_s = static_cast<double>(motion.size()) * sample_period_s;
      if (t_s >= start_s + leg.length_s) break;
      const double share = std::min(1.0, (t_s - start_s) / leg.ramp_s);
      const double speed = std::lerp(before.speed_m_s, leg.speed_m_s, share);
      const double yaw = std::lerp(before.turn_dps, leg.turn_dps, share) * kRadPerDeg;
      const double nod =
          0.004 * std::sin(2.0 * std::numbers::pi * 1.3 * t_s) * std::min(1.0, speed / 14.0);
      distance_m += speed * sample_period_s;
      motion.rate_rad_s.push_back({0.05 * yaw, nod, yaw});
      motion.speed_m_s.push_back(speed);
      motion.odometer_pulses.push_back(static_cast<std::int64_t>(distance_m / metres_per_pulse));
    }
    start_s += leg.length_s;
    before = leg;
  }
  return motion;
}

}  // namespace zerorate::simulate
