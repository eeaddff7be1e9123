/// @file
/// A simulated axis at rest as the samples that a reader would have delivered.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "host_tools/lib/identify/rest_samples.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::testing {

inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// White noise [deg/s/sqrt(Hz)] and flicker noise [deg/h at 1 rad/s] of a consumer gyro, and a
/// random walk [deg/h/sqrt(h)].
struct RestNoise {
  double angle_random_walk_dps_per_sqrt_hz = 0.04;
  double bias_instability_dph = 25.0;
  double order = 0.5;
  double rate_random_walk_dph_per_sqrt_h = 0.0;
};

inline simulate::Signal simulate_rest(const RestNoise& noise, std::size_t samples, double period_s,
                                      std::uint64_t run) {
  constexpr std::uint64_t kSeed = 20;
  std::vector<simulate::Effect> effects{
      simulate::ConstantBias{0.3 * kRadPerDeg},
      simulate::WhiteNoise{noise.angle_random_walk_dps_per_sqrt_hz * kRadPerDeg}};
  if (noise.bias_instability_dph > 0.0) {
    effects.emplace_back(
        simulate::FlickerNoise{noise.bias_instability_dph / 3600.0 * kRadPerDeg, noise.order});
  }
  if (noise.rate_random_walk_dph_per_sqrt_h > 0.0) {
    effects.emplace_back(simulate::RateRandomWalk{noise.rate_random_walk_dph_per_sqrt_h /
                                                  (3600.0 * 60.0) * kRadPerDeg});
  }
  return simulate::simulate(simulate::Signal(samples, period_s), effects,
                            random::RandomStream(kSeed, run));
}

/// One axis; missing samples are left out.
inline identify::RestSamples rest_samples_of(const simulate::Signal& signal) {
  const auto period_ns = std::llround(signal.sample_period_s * 1e9);
  identify::RestSamples samples{.axis_count = 1,
                                .sample_period = core::Duration::nanoseconds(period_ns),
                                .mean_period = core::Duration::nanoseconds(period_ns),
                                .rows = signal.size()};
  for (std::size_t k = 0; k < signal.size(); ++k) {
    if (signal.missing[k]) continue;
    samples.time.push_back(core::Instant::from_ns(static_cast<std::int64_t>(k) * period_ns));
    samples.rate_rad_s.push_back({static_cast<float>(signal.rate_rad_s[k])});
  }
  return samples;
}

/// Stops of so many samples with drives of twice that between them, in which nothing is known.
inline void drop_drives(simulate::Signal& signal, std::size_t stop) {
  for (std::size_t k = 0; k < signal.size(); ++k) {
    if (k / stop % 3 != 0) signal.missing[k] = true;
  }
}

}  // namespace zerorate::testing
