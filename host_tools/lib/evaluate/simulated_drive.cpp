#include "host_tools/lib/evaluate/simulated_drive.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/units.hpp"
#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/recording/writer.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::evaluate {
namespace {

constexpr std::size_t kYaw = 2;

using AxisRates = std::array<std::vector<double>, 3>;  ///< [rad/s]

/// Noise of one axis by the model, and a bias that is the sensor's own.
std::vector<simulate::Effect> effects_of(const model::SensorModel& model,
                                         const random::RandomStream& axis_stream) {
  std::vector<simulate::Effect> effects{
      simulate::ConstantBias{.bias_rad_s = double{core::kRadPerDeg} * axis_stream.normal(0)},
      simulate::WhiteNoise{.angle_random_walk_rad_rt_s =
                               model.white.angle_random_walk_rad_per_sqrt_s}};
  if (model.flicker) {
    effects.emplace_back(
        simulate::FlickerNoise{.bias_instability_rad_s = model.flicker->bias_instability_rad_s,
                               .order = model.flicker->order});
  }
  return effects;
}

/// Rates of a gyro that does not move.
/// @param hidden  effects that the model does not know, on the yaw axis
AxisRates rates_at_rest(const model::SensorModel& model, std::size_t size, double period_s,
                        const random::RandomStream& stream,
                        std::span<const simulate::Effect> hidden) {
  AxisRates rest;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const auto axis_stream = stream.substream("gyro").substream(i);
    std::vector<simulate::Effect> effects = effects_of(model, axis_stream);
    if (i == kYaw) effects.insert(effects.end(), hidden.begin(), hidden.end());
    rest[i] = simulate::simulate({size, period_s}, effects, axis_stream).rate_rad_s;
  }
  return rest;
}

std::int64_t time_ns(std::size_t sample, double period_s) {
  return std::llround(static_cast<double>(sample) * period_s * 1e9);
}

}  // namespace

simulate::Effect draw_hidden_tone(const model::SensorModel& model,
                                  const random::RandomStream& stream) {
  const double arw = model.white.angle_random_walk_rad_per_sqrt_s;
  const double slow = model.flicker ? model.flicker->bias_instability_rad_s : 0.03 * arw;
  return simulate::PeriodicDisturbance{.amplitude_rad_s = 8.0 * slow,
                                       .frequency_hz = 1.0 / (50.0 + 30.0 * stream.uniform(0)),
                                       .phase_rad = 2.0 * std::numbers::pi * stream.uniform(1)};
}

std::array<float, 3> SimulatedDrive::true_rate_rad_s(std::uint64_t row) const {
  const auto& rate = motion_.rate_rad_s[row];
  return {static_cast<float>(rate[0]), static_cast<float>(rate[1]), static_cast<float>(rate[2])};
}

void SimulatedDrive::write(const std::filesystem::path& path) const {
  recording::Writer writer{path, {.odometer = true}};
  recording::Row row;
  for (std::size_t k = 0; k < motion_.size(); ++k) {
    row.time_ns = time_ns(k, motion_.sample_period_s);
    for (std::size_t i = 0; i < row.rate_rad_s.size(); ++i) {
      row.rate_rad_s[i] = static_cast<float>(motion_.rate_rad_s[k][i] + rest_rate_rad_s_[i][k]);
    }
    row.odometer_pulses = motion_.odometer_pulses[k];
    writer.write(row);
  }
  writer.finish();
}

void SimulatedDrive::write_parked(const std::filesystem::path& path, double duration_s) const {
  recording::Writer writer{path, {.axis_count = 1}};
  const std::span<const double> rate = rest_rate_rad_s(kYaw);
  const auto rows = static_cast<std::size_t>(duration_s / motion_.sample_period_s);
  for (std::size_t k = 0; k < std::min(rows, rate.size()); ++k) {
    writer.write({.time_ns = time_ns(k, motion_.sample_period_s),
                  .rate_rad_s = {static_cast<float>(rate[k])}});
  }
  writer.finish();
}

SimulatedDrive simulate_drive(const SimulatedDriveParams& params) {
  const random::RandomStream stream{params.seed};
  const double period_s = 1.0 / params.sample_rate_hz;
  auto motion = simulate::simulate_vehicle({.duration_s = params.duration_s}, period_s, stream);
  AxisRates rest = rates_at_rest(params.model, motion.size(), period_s, stream, params.hidden);
  return {std::move(motion), std::move(rest)};
}

std::array<std::vector<double>, 3> simulate_rest(const SimulatedRestParams& params) {
  const auto size = static_cast<std::size_t>(params.duration_s * params.sample_rate_hz);
  return rates_at_rest(params.model, size, 1.0 / params.sample_rate_hz,
                       random::RandomStream{params.seed}, {});
}

void write_simulated_rest(const SimulatedRestParams& params, const std::filesystem::path& path) {
  const double period_s = 1.0 / params.sample_rate_hz;
  const AxisRates rest = simulate_rest(params);
  recording::Writer writer{path, {}};
  for (std::size_t k = 0; k < rest[0].size(); ++k) {
    writer.write({.time_ns = time_ns(k, period_s),
                  .rate_rad_s = {static_cast<float>(rest[0][k]), static_cast<float>(rest[1][k]),
                                 static_cast<float>(rest[2][k])}});
  }
  writer.finish();
}

RestRecording read_at_rest(const recording::Input& input, std::size_t axis) {
  recording::Reader reader{input};
  const std::size_t column = std::min(axis, reader.columns().axis_count - 1);
  RestRecording rest;
  for (recording::Row row; reader.next(row);) {
    if (!row.findings.has(recording::Finding::rate_lost)) {
      rest.rate_rad_s.push_back(double{row.rate_rad_s[column]});
    }
  }
  rest.sample_period_s = static_cast<double>(reader.findings().mean_interval_ns()) * 1e-9;
  return rest;
}

}  // namespace zerorate::evaluate
