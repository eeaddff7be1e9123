/// @file
/// A node of two samples a second, for campaigns of thousands of drives in which nothing quick
/// happens.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "firmware/app/gyro_node.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::scenario {

inline constexpr double kSlowPeriod_s = 0.5;

template <core::ModelShape Shape>
[[nodiscard]] app::NodeParams<Shape> slow_params(const model::SensorModel& model) {
  const auto period = core::Duration::milliseconds(500);
  const auto noise = model::make_node_model<Shape>(model, period, period);
  return {.model = {.modes = noise.modes,
                    .white_variance_rad2_s2 = noise.white_variance_rad2_s2,
                    .measurement_floor_variance_rad2_s2 = noise.measurement_floor_variance_rad2_s2,
                    .turn_on_variance_rad2_s2 = noise.turn_on_variance_rad2_s2,
                    .sample_period = period,
                    .hypotheses = noise.hypotheses}};
}

/// Three axes of a gyro, each with noise of its own.
struct SlowGyro {
  std::array<std::vector<double>, 3> bias_rad_s;
  std::array<std::vector<double>, 3> measured_rad_s;

  /// @param effects of the bias, of an axis whose stream is given
  template <class Effects>
  SlowGyro(std::size_t samples, double arw_rad_rt_s, std::uint64_t seed, Effects effects) {
    const simulate::Signal empty{samples, kSlowPeriod_s};
    const std::vector<simulate::Effect> white{
        simulate::WhiteNoise{.angle_random_walk_rad_rt_s = arw_rad_rt_s}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const random::RandomStream stream{seed, axis};
      const std::vector<simulate::Effect> slow = effects(stream);
      bias_rad_s[axis] = simulate::simulate(empty, slow, stream).rate_rad_s;
      measured_rad_s[axis] = simulate::simulate(empty, white, stream).rate_rad_s;
      for (std::size_t k = 0; k < samples; ++k) measured_rad_s[axis][k] += bias_rad_s[axis][k];
    }
  }
};

[[nodiscard]] inline core::Instant slow_instant(std::size_t k) {
  return core::Instant::from_ns(static_cast<std::int64_t>(k + 1) * 500'000'000);
}

/// One sample of the gyro as the node's k-th; on the move it turns, and the odometer counts.
template <class Node>
app::RateMessage step_slowly(Node& node, const SlowGyro& gyro, std::size_t sample, std::size_t k,
                             bool moves) {
  if (moves) node.pulse(slow_instant(k));
  const double turn_rad_s = moves ? 0.1 * std::sin(0.3 * static_cast<double>(k)) : 0.0;
  core::GyroSample measured{.time = slow_instant(k)};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    measured.rate[axis] =
        core::rad_per_s(static_cast<float>(gyro.measured_rad_s[axis][sample] + turn_rad_s));
  }
  return node.step(measured);
}

/// Bias left after correction [rad/s].
template <class Node>
[[nodiscard]] double left_rad_s(const Node& node, const SlowGyro& gyro, std::size_t sample,
                                std::size_t axis) {
  return gyro.bias_rad_s[axis][sample] -
         double{node.bias(app::Predictor::kalman, axis).in(core::rad_per_s)};
}

}  // namespace zerorate::scenario
