#include "host_tools/lib/simulate/scenario.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::simulate {
namespace {

using units::kRadPerDeg;
constexpr std::size_t kYaw = 2;

Signal signal_of(const VehicleMotion& motion, const ScenarioGyro& gyro) {
  Signal signal{motion.size(), motion.sample_period_s};
  if (!gyro.temperature_degc) return signal;
  for (std::size_t k = 0; k < signal.size(); ++k) {
    signal.temperature_degc.push_back(gyro.temperature_degc(signal.time_s(k)));
  }
  return signal;
}

double within_a_turn(double heading_rad) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  return heading_rad - kTurn * std::floor(heading_rad / kTurn);
}

/// Heading within a turn, counter-clockwise from that at the start.
void add_reference(const VehicleMotion& motion, ScenarioDrive& drive) {
  drive.columns.ref_heading = true;
  drive.columns.ref_rate = true;
  drive.columns.ref_speed = true;
  double wrapped = 0.0;
  double heading = 0.0;
  for (std::size_t k = 0; k < motion.size(); ++k) {
    recording::Row& row = drive.rows[k].row;
    drive.rows[k].true_heading_rad = heading;
    row.ref_heading_rad = static_cast<float>(wrapped);
    row.ref_rate_rad_s = static_cast<float>(motion.turn_rad_s[k]);
    row.ref_speed_m_s = static_cast<float>(motion.speed_m_s[k]);
    heading += motion.turn_rad_s[k] * motion.sample_period_s;
    wrapped = within_a_turn(wrapped + motion.turn_rad_s[k] * motion.sample_period_s);
  }
}

/// Readings of an accelerometer in the gyro's chip: a consumer's noise, and the shaking of the
/// road.
void add_forces(const VehicleMotion& motion, const Tilt& mounting,
                const random::RandomStream& stream, ScenarioDrive& drive) {
  constexpr double kNoise_g = 0.001;
  constexpr double kRoad_g_per_m_s = 0.002;
  for (std::size_t k = 0; k < motion.force_g.size(); ++k) {
    const auto force_g = seen_by(mounting, motion.force_g[k]);
    const double shake_g = kNoise_g + kRoad_g_per_m_s * motion.speed_m_s[k];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double noise = stream.normal(static_cast<std::int64_t>(3 * k + axis));
      drive.rows[k].row.acceleration_m_s2[axis] =
          static_cast<float>(units::kGravity_m_s2 * (force_g[axis] + shake_g * noise));
    }
  }
}

}  // namespace

ScenarioDrive record(const VehicleMotion& motion, const ScenarioGyro& gyro, std::uint64_t seed) {
  ScenarioDrive drive;
  drive.columns.odometer = true;
  drive.columns.temperature = static_cast<bool>(gyro.temperature_degc);
  drive.rows.resize(motion.size());
  add_reference(motion, drive);
  add_forces(motion, gyro.errors.mounting, random::RandomStream{seed}.substream("accelerometer"),
             drive);
  const Signal empty = signal_of(motion, gyro);
  const random::RandomStream stream{seed};
  const double floor_rad_s = gyro.bias_instability_dph / 3600.0 * kRadPerDeg;
  const double flicker_rad_s = floor_rad_s / std::sqrt(2.0 * std::numbers::ln2 / std::numbers::pi);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<Effect> drift{ConstantBias{.bias_rad_s = gyro.bias_dps[axis] * kRadPerDeg},
                              FlickerNoise{.bias_instability_rad_s = flicker_rad_s}};
    if (axis == kYaw) drift.insert(drift.end(), gyro.drift.begin(), gyro.drift.end());
    std::vector<Effect> noise{
        WhiteNoise{.angle_random_walk_rad_rt_s = gyro.arw_dps_rt_s * kRadPerDeg}};
    noise.insert(noise.end(), gyro.disturbance.begin(), gyro.disturbance.end());
    const Signal bias = simulate(empty, drift, stream.substream(axis));
    const Signal fast = simulate(empty, noise, stream.substream(axis));
    for (std::size_t k = 0; k < motion.size(); ++k) {
      ScenarioRow& row = drive.rows[k];
      const double rate = gyro.errors.measured(motion.rate_rad_s[k])[axis];
      const double slow = bias.rate_rad_s[k] + gyro.errors.offset(axis, motion.speed_m_s[k]);
      row.true_rate_rad_s[axis] = static_cast<float>(motion.rate_rad_s[k][axis]);
      row.bias_rad_s[axis] = static_cast<float>(slow);
      row.row.rate_rad_s[axis] = static_cast<float>(rate + slow + fast.rate_rad_s[k]);
    }
  }
  const random::RandomStream thermometer = stream.substream("thermometer");
  for (std::size_t k = 0; k < motion.size(); ++k) {
    recording::Row& row = drive.rows[k].row;
    row.time_ns = std::llround(empty.time_s(k) * 1e9);
    row.odometer_pulses = motion.odometer_pulses[k];
    if (!gyro.temperature_degc) continue;
    const double noise_k = 0.1 * thermometer.normal(static_cast<std::int64_t>(k));
    row.temperature_degc = static_cast<float>(empty.temperature_degc[k] + noise_k);
  }
  return drive;
}

void show_references(std::vector<SensedHeading> headings, ScenarioDrive& drive) {
  for (ScenarioRow& row : drive.rows) {
    row.row.ref_heading_rad = std::numeric_limits<float>::quiet_NaN();
  }
  for (const SensedHeading& heading : headings) {
    const auto row =
        std::ranges::lower_bound(drive.rows, std::llround(heading.time_s * 1e9), {},
                                 [](const ScenarioRow& each) { return each.row.time_ns; });
    if (row == drive.rows.end()) break;
    row->row.ref_heading_rad = static_cast<float>(within_a_turn(heading.heading_rad));
  }
  drive.references = std::move(headings);
}

}  // namespace zerorate::simulate
