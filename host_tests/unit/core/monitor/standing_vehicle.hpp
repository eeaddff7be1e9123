/// @file
/// A vehicle that stands or turns, seen tick by tick by the check of its odometer.
#pragma once

#include <cstdint>

#include "core/base/units.hpp"
#include "core/monitor/odometer_check.hpp"

namespace zerorate::core {

using Check = OdometerCheck<3>;
using Rates = Check::Rates;

constexpr Duration kTick = Duration::milliseconds(500);
constexpr Duration kSamplePeriod = Duration::milliseconds(10);
constexpr std::uint32_t kSamples = 50;  ///< samples of a full tick
constexpr float kSigmaRadS = 1e-3F;     ///< noise of a sample: 0.008 deg/s for a tick
/// Variance of a prediction: 0.006 deg/s.
constexpr float kVariance = 1e-8F;
constexpr Rates kBias{12.0F * kRadPerDeg, -0.3F * kRadPerDeg, 0.1F * kRadPerDeg};

/// About z, on top of the bias.
inline Rates turning(float dps) {
  return {kBias[0], kBias[1], kBias[2] + dps * kRadPerDeg};
}

inline Check make_check(const OdometerCheckParams& params = {}, Duration tick = kTick) {
  return Check{params, tick, kSamplePeriod, kSigmaRadS * kSigmaRadS};
}

inline void stand(Check& check, const Rates& mean, int ticks, const Rates* predicted = nullptr) {
  for (int i = 0; i < ticks; ++i) check.on_standing_tick(mean, kSamples, predicted, kVariance);
}

/// Ticks until turns() is as wanted, 1000 if it never is.
inline int ticks_until(Check& check, const Rates& mean, bool turns,
                       const Rates* predicted = &kBias) {
  for (int ticks = 1; ticks < 1000; ++ticks) {
    check.on_standing_tick(mean, kSamples, predicted, kVariance);
    if (check.turns() == turns) return ticks;
  }
  return 1000;
}

}  // namespace zerorate::core
