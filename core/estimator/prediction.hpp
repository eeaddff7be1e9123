/// @file
/// Answers of a bias predictor: predictions, and the innovation of a measurement.
#pragma once

#include <limits>

#include "core/base/numeric.hpp"

namespace zerorate::core {

/// A predicted bias with its variance. Without a measurement the variance is infinite.
struct Prediction {
  float bias_rad_s = 0.0F;
  float variance_rad2_s2 = std::numeric_limits<float>::infinity();

  constexpr bool operator==(const Prediction&) const = default;
  [[nodiscard]] constexpr bool is_available() const { return is_finite(variance_rad2_s2); }
  [[nodiscard]] constexpr float sigma_rad_s() const { return square_root(variance_rad2_s2); }
  /// The interval of the next raw sample is wider: the white noise of that sample adds.
  [[nodiscard]] constexpr Prediction of_raw_sample(float white_variance_rad2_s2) const {
    return {bias_rad_s, variance_rad2_s2 + white_variance_rad2_s2};
  }
};

/// The predicted integral of the bias over a coming drive: the heading error of an uncorrected
/// gyro, and the variance of what remains after correction.
struct HeadingPrediction {
  float angle_rad = 0.0F;
  float variance_rad2 = std::numeric_limits<float>::infinity();

  [[nodiscard]] constexpr bool is_available() const { return is_finite(variance_rad2); }
  [[nodiscard]] constexpr float sigma_rad() const { return square_root(variance_rad2); }
};

/// Outcome of one measurement.
struct Innovation {
  bool accepted =
      false;  ///< false: not finite, or a variance that is not positive; nothing changed
  bool rejected = false;  ///< not accepted, because too far from the prediction (see Gate)
  bool first = false;     ///< accepted as the first ever: there was no prediction to compare with
  float residual_rad_s = 0.0F;    ///< measured - predicted
  float variance_rad2_s2 = 0.0F;  ///< predicted variance of the residual

  constexpr bool operator==(const Innovation&) const = default;
  /// Normalised innovation squared; its mean is 1 if the model is right.
  [[nodiscard]] constexpr float normalised_squared() const {
    return variance_rad2_s2 > 0.0F ? residual_rad_s * residual_rad_s / variance_rad2_s2 : 0.0F;
  }
};

/// A measurement that a predictor may learn from.
[[nodiscard]] constexpr bool is_measurement(float rate_rad_s, float variance_rad2_s2) {
  return is_finite(rate_rad_s) && is_finite_positive(variance_rad2_s2);
}

}  // namespace zerorate::core
