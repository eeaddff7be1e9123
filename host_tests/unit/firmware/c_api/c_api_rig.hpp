/// @file
/// A drive as vehicle firmware feeds it: stops and turns of a gyro with a bias, at 100 Hz.
#pragma once

#include <zerorate.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "firmware/c_api/examples/front_gyro.h"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::c_api::testing {

inline constexpr std::int64_t kPeriod_ns = 10'000'000;
inline constexpr float kPeriod_s = 0.01F;
inline constexpr std::array<float, 3> kBias = {0.02F, -0.01F, 0.015F};
/// A minute's stop, half a minute's turn, and so on.
inline constexpr std::int64_t kStopSamples = 6000;
inline constexpr std::int64_t kDriveSamples = 3000;
inline constexpr float kTurn_rad_s = 0.2F;

struct Moment {
  zerorate_measurement measured;
  bool stands;
};

/// White noise of the model's strength, drawn anew for each sample and axis.
inline Moment moment(std::int64_t k, std::uint64_t seed = 1) {
  Moment now{.measured = {.time_ns = k * kPeriod_ns},
             .stands = k % (kStopSamples + kDriveSamples) < kStopSamples};
  const double sigma = std::sqrt(static_cast<double>(front_gyro.white_variance_rad2_s2));
  for (std::size_t i = 0; i < kBias.size(); ++i) {
    const double noise = sigma * random::RandomStream{seed, i}.normal(k);
    now.measured.rate_rad_s[i] = kBias[i] + static_cast<float>(noise);
  }
  if (!now.stands) now.measured.rate_rad_s[2] += kTurn_rad_s;
  return now;
}

inline zerorate_rate feed(zerorate_node& node, const Moment& now) {
  zerorate_rate rate{};
  zerorate_zero_velocity(&node, now.measured.time_ns, now.stands);
  zerorate_sample(&node, &now.measured, &rate);
  return rate;
}

}  // namespace zerorate::c_api::testing
