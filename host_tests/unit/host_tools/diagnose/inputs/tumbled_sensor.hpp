/// @file
/// A sensor at rest in one attitude after the other, with noise and biases that are known.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/base/units.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::diagnose::testing {

inline constexpr double kRadPerDeg = 3.14159265358979323846 / 180.0;

using Vector = std::array<double, 3>;

struct Tumble {
  std::size_t stops = 12;
  double stop_s = 30.0;
  double drive_s = 10.0;
  double period_s = 0.02;
  Vector dps_per_g{};                              ///< sensitivity of the x axis
  double dps_per_g2 = 0.0;                         ///< rectification of the x axis
  std::function<double(std::size_t)> shaking_g{};  ///< rms along each axis, by stop
  /// Directions of the acceleration, by stop; turned about at random without.
  std::function<Vector(std::size_t)> attitude{};
  double bias_instability_dps = 0.005;
  double random_walk_dps_rt_s = 0.0;
  std::uint64_t seed = 1;
};

inline Vector random_attitude(const random::RandomStream& stream, std::size_t stop) {
  Vector g{};
  double square = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    g[i] = random::normal_quantile(stream.uniform(static_cast<std::int64_t>(3 * stop + i)));
    square += g[i] * g[i];
  }
  for (double& along : g) along /= std::sqrt(square);
  return g;
}

/// Samples at rest of three axes; only the first depends on the acceleration. White noise of
/// 0.02 deg/s/sqrt(s).
inline identify::RestSamples samples_of(const Tumble& tumble) {
  const auto rest = static_cast<std::size_t>(tumble.stop_s / tumble.period_s);
  const auto drive = static_cast<std::size_t>(tumble.drive_s / tumble.period_s);
  const std::size_t count = tumble.stops * (rest + drive);
  std::array<std::vector<double>, 3> rates;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<simulate::Effect> effects{
        simulate::ConstantBias{.bias_rad_s = 0.3 * kRadPerDeg},
        simulate::WhiteNoise{.angle_random_walk_rad_rt_s = 0.02 * kRadPerDeg}};
    if (tumble.bias_instability_dps > 0.0) {
      effects.emplace_back(simulate::FlickerNoise{.bias_instability_rad_s =
                                                      tumble.bias_instability_dps * kRadPerDeg});
    }
    rates[axis] = simulate::simulate(simulate::Signal{count, tumble.period_s}, effects,
                                     random::RandomStream{tumble.seed, axis})
                      .rate_rad_s;
  }
  const random::RandomStream turns{tumble.seed, 7};
  const random::RandomStream shakes{tumble.seed, 8};
  const auto period_ns = static_cast<std::int64_t>(tumble.period_s * 1e9 + 0.5);
  identify::RestSamples samples{.sample_period = core::Duration::nanoseconds(period_ns),
                                .mean_period = core::Duration::nanoseconds(period_ns)};
  for (std::size_t stop = 0; stop < tumble.stops; ++stop) {
    const Vector g = tumble.attitude ? tumble.attitude(stop) : random_attitude(turns, stop);
    const double shaking_g = tumble.shaking_g ? tumble.shaking_g(stop) : 0.002;
    double bias_dps = tumble.dps_per_g2 * 3.0 * shaking_g * shaking_g;
    for (std::size_t i = 0; i < 3; ++i) bias_dps += tumble.dps_per_g[i] * g[i];
    if (stop > 0) samples.after_drives.push_back(samples.time.size());
    for (std::size_t k = stop * (rest + drive); k < stop * (rest + drive) + rest; ++k) {
      samples.time.push_back(core::Instant::from_ns(static_cast<std::int64_t>(k) * period_ns));
      std::array<float, 3> rate{};
      std::array<float, 3> acceleration{};
      for (std::size_t i = 0; i < 3; ++i) {
        rate[i] = static_cast<float>(rates[i][k] + (i == 0 ? bias_dps * kRadPerDeg : 0.0));
        const double shake =
            random::normal_quantile(shakes.uniform(static_cast<std::int64_t>(3 * k + i)));
        acceleration[i] =
            static_cast<float>((g[i] + shaking_g * shake) * double{core::kStandardGravity_m_s2});
      }
      samples.rate_rad_s.push_back(rate);
      samples.acceleration_m_s2.push_back(acceleration);
    }
  }
  return samples;
}

}  // namespace zerorate::diagnose::testing
