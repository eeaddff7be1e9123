#include "host_tools/lib/simulate/scenario.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

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

/// Heading within a turn, counter-clockwise from that at the start.
void add_reference(const VehicleMotion& motion, ScenarioDrive& drive) {
  drive.columns.ref_heading = true;
  drive.columns.ref_rate = true;
  drive.columns.ref_speed = true;
  constexpr double kTurn = 2.0 * std::numbers::pi;
  double heading = 0.0;
  for (std::size_t k = 0; k < motion.size(); ++k) {
    recording::Row& row = drive.rows[k].row;
    row.ref_heading_rad = static_cast<float>(heading);
    row.ref_rate_rad_s = static_cast<float>(motion.rate_rad_s[k][kYaw]);
    row.ref_speed_m_s = static_cast<float>(motion.speed_m_s[k]);
    heading += motion.rate_rad_s[k][kYaw] * motion.sample_period_s;
    heading -= kTurn * std::floor(heading / kTurn);
  }
}

}  // namespace

ScenarioDrive record(const VehicleMotion& motion, const ScenarioGyro& gyro, std::uint64_t seed) {
  ScenarioDrive drive;
  drive.columns.odometer = true;
  drive.columns.temperature = static_cast<bool>(gyro.temperature_degc);
  drive.rows.resize(motion.size());
  add_reference(motion, drive);
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
      const double rate = motion.rate_rad_s[k][axis];
      row.true_rate_rad_s[axis] = static_cast<float>(rate);
      row.bias_rad_s[axis] = static_cast<float>(bias.rate_rad_s[k]);
      row.row.rate_rad_s[axis] = static_cast<float>(rate + bias.rate_rad_s[k] + fast.rate_rad_s[k]);
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

}  // namespace zerorate::simulate
