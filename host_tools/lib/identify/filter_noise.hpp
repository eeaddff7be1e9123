/// @file
/// A characterization as other programs take a gyroscope: white noise and a random walk of the
/// bias, without flicker noise.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "host_tools/lib/identify/characterize.hpp"

namespace zerorate::identify {

/// N and K fitted without flicker noise, root mean square over the axes. Two-sided densities.
struct FilterNoise {
  std::string recording;
  std::size_t axes = 0;
  double white_rad_per_sqrt_s = 0.0;            ///< N
  std::optional<double> walk_rad_s_per_sqrt_s;  ///< K; nullopt: not detectable on any axis
  double sample_rate_hz = 0.0;

  /// @param result  at least one axis
  [[nodiscard]] static FilterNoise of(const Characterization& result);
};

/// The imu.yaml of Kalibr and of those who took it over: N [rad/s/sqrt(Hz)], K [rad/s^2/sqrt(Hz)].
/// A figure that the recording does not show is a comment.
[[nodiscard]] std::string kalibr_yaml(const FilterNoise& noise);

/// Python source that sets the gyroscope of a gtsam.PreintegrationCombinedParams: N^2 [rad^2/s] and
/// K^2 [rad^2/s^3].
[[nodiscard]] std::string gtsam_python(const FilterNoise& noise);

/// MATLAB function that gives gyroparams for imuSensor. With its NoiseType "double-sided", the
/// default, imuSensor draws samples of the deviation NoiseDensity sqrt(SampleRate / 2) and steps of
/// RandomWalk / sqrt(SampleRate / 2): NoiseDensity is sqrt(2) N, the one-sided density of data
/// sheets, and RandomWalk is K / sqrt(2).
[[nodiscard]] std::string matlab_function(const FilterNoise& noise);

/// The covariance of sensor_msgs/Imu that robot_localization reads: N^2 times the rate of the
/// samples [rad^2/s^2].
[[nodiscard]] std::string robot_localization_yaml(const FilterNoise& noise);

}  // namespace zerorate::identify
