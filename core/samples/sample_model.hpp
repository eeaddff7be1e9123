/// @file
/// Model of single samples besides white noise: what a mean over a tick would hide.
#pragma once

#include <limits>

#include "core/base/numeric.hpp"

namespace zerorate::core {

/// Single wild samples: a share of them has noise of its own on top.
struct Outliers {
  float probability = 0.0F;       ///< probability of one; 0: there are none
  float variance_rad2_s2 = 0.0F;  ///< variance of the error that is added

  constexpr bool operator==(const Outliers&) const = default;
  [[nodiscard]] constexpr bool is_on() const { return is_finite_positive(probability); }
  /// Variance that they add to a sum of many samples, for each of them.
  [[nodiscard]] constexpr float variance_in_sums() const { return probability * variance_rad2_s2; }
};

/// Rotations inside what is held for a standstill: an offset that comes, lasts and goes.
struct MotionEvents {
  float begin_probability = 0.0F;  ///< at a sample, while there is none; 0: there never is one
  float end_probability = 1.0F;    ///< at a sample, while there is one: 1 / mean length in samples
  float variance_rad2_s2 = 0.0F;   ///< variance of the offset, whose memory is its mean length

  constexpr bool operator==(const MotionEvents&) const = default;
  [[nodiscard]] constexpr bool is_on() const { return is_finite_positive(begin_probability); }
  /// Variance that it adds to a sum of many samples, for each of them: its variance, by the
  /// share of the time that it lasts, over the lengths that its memory reaches to both sides.
  [[nodiscard]] constexpr float variance_in_sums() const {
    const float share = begin_probability / (begin_probability + end_probability);
    return share * variance_rad2_s2 * (2.0F / end_probability - 1.0F);
  }
};

/// White noise whose strength wanders: its variance over the nominal one is a Gauss-Markov process
/// around 1.
struct NoiseLevel {
  float variance = 0.0F;                 ///< stationary; 0: the strength is constant
  float time_constants_per_tick = 1.0F;  ///< larger forgets quicker

  constexpr bool operator==(const NoiseLevel&) const = default;
  [[nodiscard]] constexpr bool is_on() const { return is_finite_positive(variance); }
};

/// Range of the sensor: beyond an end it says the end.
struct MeasuringRange {
  float lower_rad_s = -std::numeric_limits<float>::infinity();
  float upper_rad_s = std::numeric_limits<float>::infinity();

  constexpr bool operator==(const MeasuringRange&) const = default;
  [[nodiscard]] constexpr bool is_saturated(float rate_rad_s) const {
    return rate_rad_s <= lower_rad_s || rate_rad_s >= upper_rad_s;
  }
};

/// All of it, for one axis; off by default.
struct SampleModel {
  Outliers outliers;
  MotionEvents motion;
  NoiseLevel level;
  MeasuringRange range;

  constexpr bool operator==(const SampleModel&) const = default;
  [[nodiscard]] constexpr bool is_on() const {
    return needs_screen() || is_finite(range.lower_rad_s) || is_finite(range.upper_rad_s);
  }
  /// Whether samples must be looked at one by one, which needs core::SampleScreen.
  [[nodiscard]] constexpr bool needs_screen() const {
    return outliers.is_on() || motion.is_on() || level.is_on();
  }
};

}  // namespace zerorate::core
