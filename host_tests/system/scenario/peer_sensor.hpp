/// @file
/// Simulated sensors on which other people's filters were measured: white noise, and 1/f noise as
/// six lags of equal variance.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/noise/terms.hpp"
#include "firmware/model/sensor_model.hpp"
#include "host_tests/system/scenario/slow_node.hpp"

namespace zerorate::scenario {

inline constexpr double kRadPerDeg = 3.14159265358979323846 / 180.0;

inline constexpr std::array kLags_s{0.1, 1.0, 10.0, 100.0, 1e3, 1e4};

struct PeerSensor {
  const char* name;
  double arw_dps_rt_s;
  double lag_sigma_dph;
  double warm_up_dps;
  double drift_bar_deg;
  /// Sigma that their filter with true parameters gave its bias while driving. It depends on
  /// nothing but sensor and schedule, and so tells whether this is the sensor that they had.
  double bias_sigma_dph;
};
inline constexpr PeerSensor kA{"A", 0.005, 3.0, 0.0, 0.053, 6.1};
inline constexpr PeerSensor kB{"B", 0.010, 10.0, 0.0, 0.168, 19.8};
inline constexpr double kWarmUp_s = 600.0;

[[nodiscard]] inline std::vector<simulate::Effect> effects_of(const PeerSensor& sensor) {
  std::vector<simulate::Effect> effects{simulate::ConstantBias{.bias_rad_s = 0.3 * kRadPerDeg}};
  for (const double lag_s : kLags_s) {
    effects.emplace_back(simulate::CorrelatedNoise{
        .sigma_rad_s = sensor.lag_sigma_dph / 3600.0 * kRadPerDeg, .time_constant_s = lag_s});
  }
  if (sensor.warm_up_dps > 0.0) {
    effects.emplace_back(simulate::WarmUpTransient{
        .amplitude_rad_s = sensor.warm_up_dps * kRadPerDeg, .time_constant_s = kWarmUp_s});
  }
  return effects;
}

/// The sensor itself: its lags, and the warm-up if the node is to know of it.
template <std::size_t R>
[[nodiscard]] typename app::GyroNode<core::ModelShape{.decaying = R}>::Params params_of(
    const PeerSensor& sensor) {
  constexpr auto kPeriod = core::Duration::milliseconds(500);
  const double lag_sigma = sensor.lag_sigma_dph / 3600.0 * kRadPerDeg;
  core::FlickerDecades<6> lags;
  for (std::size_t i = 0; i < kLags_s.size(); ++i) {
    lags.time_constant_s[i] = static_cast<float>(kLags_s[i]);
    lags.variance_rad2_s2[i] = static_cast<float>(lag_sigma * lag_sigma);
  }
  const double arw = sensor.arw_dps_rt_s * kRadPerDeg;
  typename app::GyroNode<core::ModelShape{.decaying = R}>::Params params{
      .model = {.white_variance_rad2_s2 = static_cast<float>(arw * arw / kSlowPeriod_s),
                .sample_period = kPeriod},
      .learns_white_noise = false};  // the model is the sensor
  if constexpr (R == 6) {
    params.model.modes = core::compose(kPeriod, core::Start::stationary, lags);
  } else {
    const core::WarmUp warm_up{.sigma_rad_s = static_cast<float>(0.05 * kRadPerDeg),
                               .time_constant_s = static_cast<float>(kWarmUp_s)};
    params.model.modes = core::compose(kPeriod, core::Start::stationary, lags, warm_up);
  }
  return params;
}

/// Data sheet of a peer sensor whose figures are off by factors. A lag a decade has 1.289 times the
/// Allan floor, which is 0.664 B.
[[nodiscard]] inline model::SensorModel data_sheet(const PeerSensor& sensor, double white_factor,
                                                   double slow_factor) {
  model::SensorModel model{.name = sensor.name};
  model.white.angle_random_walk_rad_per_sqrt_s = white_factor * sensor.arw_dps_rt_s * kRadPerDeg;
  model.flicker = model::Flicker{.bias_instability_rad_s = slow_factor * sensor.lag_sigma_dph /
                                                           3600.0 * kRadPerDeg / (1.289 * 0.664)};
  return model;
}

}  // namespace zerorate::scenario
