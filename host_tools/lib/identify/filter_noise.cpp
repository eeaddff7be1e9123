#include "host_tools/lib/identify/filter_noise.hpp"

#include <fmt/format.h>
#include <cmath>
#include <numbers>

namespace zerorate::identify {
namespace {

/// First lines of each file, as comments of its language.
std::string heading_of(const FilterNoise& noise, const char* comment) {
  return fmt::format(
      "{0} {1}, by zerorate characterize; root mean square over {2} {3}.\n"
      "{0} White noise and random walk fitted together: this file has no flicker noise.\n",
      comment, noise.recording, noise.axes, noise.axes == 1 ? "axis" : "axes");
}

/// A line, or a comment where the recording does not show the random walk.
std::string walk_line(const FilterNoise& noise, const char* comment, const std::string& before,
                      double factor, const std::string& after) {
  if (!noise.walk_rad_s_per_sqrt_s)
    return fmt::format("{} {}not detectable{}", comment, before, after);
  return fmt::format("{}{:.6g}{}", before, factor * *noise.walk_rad_s_per_sqrt_s, after);
}

}  // namespace

FilterNoise FilterNoise::of(const Characterization& result) {
  double white = 0.0;
  double walk = 0.0;
  for (const AxisCharacterization& axis : result.axes) {
    const auto& pair = axis.coefficients.without_flicker;
    const auto& n = pair ? pair->angle_random_walk_rad_per_sqrt_s
                         : axis.coefficients.angle_random_walk_rad_per_sqrt_s;
    white += n.value * n.value;
    if (!pair) continue;
    walk += pair->rate_random_walk_rad_s_per_sqrt_s.value *
            pair->rate_random_walk_rad_s_per_sqrt_s.value;
  }
  const auto axes = static_cast<double>(result.axes.size());
  FilterNoise noise{.recording = result.recording,
                    .axes = result.axes.size(),
                    .white_rad_per_sqrt_s = std::sqrt(white / axes),
                    .sample_rate_hz = 1e9 / static_cast<double>(result.sample_period.ns())};
  if (walk > 0.0) noise.walk_rad_s_per_sqrt_s = std::sqrt(walk / axes);
  return noise;
}

std::string kalibr_yaml(const FilterNoise& noise) {
  return heading_of(noise, "#") +
         fmt::format("gyroscope_noise_density: {:.6g}  # N [rad/s/sqrt(Hz)]\n",
                     noise.white_rad_per_sqrt_s) +
         walk_line(noise, "#", "gyroscope_random_walk: ", 1.0, "  # K [rad/s^2/sqrt(Hz)]\n") +
         fmt::format(
             "# accelerometer_noise_density, accelerometer_random_walk: add those of your "
             "accelerometer.\n"
             "rostopic: /imu0\n"
             "update_rate: {:.6g}  # Hz\n",
             noise.sample_rate_hz);
}

std::string gtsam_python(const FilterNoise& noise) {
  const double n = noise.white_rad_per_sqrt_s;
  return heading_of(noise, "#") +
         fmt::format(
             "import numpy as np\n\n\n"
             "def set_gyroscope(parameters):\n"
             "    \"\"\"Of a gtsam.PreintegrationCombinedParams; the accelerometer is not "
             "set.\"\"\"\n"
             "    parameters.setGyroscopeCovariance({:.6g} * np.eye(3))  # N^2 [rad^2/s]\n",
             n * n) +
         walk_line(noise, "    #",
                   noise.walk_rad_s_per_sqrt_s ? "    parameters.setBiasOmegaCovariance("
                                               : "setBiasOmegaCovariance: ",
                   noise.walk_rad_s_per_sqrt_s.value_or(0.0),
                   noise.walk_rad_s_per_sqrt_s ? " * np.eye(3))  # K^2 [rad^2/s^3]\n" : "\n");
}

std::string matlab_function(const FilterNoise& noise) {
  using std::numbers::sqrt2;
  return "function gyro = zerorate_gyroscope()\n" + heading_of(noise, "%") +
         fmt::format(
             "% For imuSensor('SampleRate', {:.6g}, 'Gyroscope', zerorate_gyroscope()).\n"
             "gyro = gyroparams;  % NoiseType \"double-sided\", the default\n"
             "gyro.NoiseDensity = {:.6g};  % sqrt(2) N, one-sided [(rad/s)/sqrt(Hz)]\n",
             noise.sample_rate_hz, sqrt2 * noise.white_rad_per_sqrt_s) +
         walk_line(noise, "%", "gyro.RandomWalk = ", 1.0 / sqrt2,
                   ";  % K / sqrt(2) [(rad/s) sqrt(Hz)]\n") +
         "gyro.BiasInstability = 0;  % its filter makes no 1/f noise unless it gets coefficients\n"
         "end\n";
}

std::string robot_localization_yaml(const FilterNoise& noise) {
  const double variance =
      noise.white_rad_per_sqrt_s * noise.white_rad_per_sqrt_s * noise.sample_rate_hz;
  return heading_of(noise, "#") +
         fmt::format(
             "# For sensor_msgs/Imu. robot_localization has no state for the bias of a gyro: "
             "publish\n"
             "# rates that are corrected, with the variance of the bias added (host_tools/ros).\n"
             "angular_velocity_covariance: [{0:.6g}, 0, 0, 0, {0:.6g}, 0, 0, 0, {0:.6g}]\n"
             "# N^2 times the rate [rad^2/s^2]\n"
             "update_rate: {1:.6g}  # Hz\n",
             variance, noise.sample_rate_hz);
}

}  // namespace zerorate::identify
