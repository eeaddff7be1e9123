/// @file
/// Rule for a measurement that is too far from its prediction.
#pragma once

#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/estimator/prediction.hpp"

namespace zerorate::core {

/// A measurement that is farther than `threshold_sigma` of the innovation from its prediction, on
/// any axis, is a knock, unless there have been `longest_knock_ticks` of them without one that
/// agreed: then it was a change of the bias.
///
/// Until that is decided, the square of the knock counts as variance of the prediction, by the
/// share of the time that has passed. A measurement that agrees ends this, and nothing is lost.
/// When the time is over, the level is assumed to have jumped to the last measurement, and is
/// learnt anew from it. The state of the noise is kept: a jump of the level does not change it. So
/// a jump is re-acquired at the (longest_knock_ticks + 1)th measurement after it.
///
/// Before the first measurement is confirmed (KalmanBank::State::is_confirmed), one that is too far
/// from it takes its place.
struct Gate {
  float threshold_sigma = 0.0F;  ///< 0: no gate
  std::uint16_t longest_knock_ticks = 0;

  constexpr bool operator==(const Gate&) const = default;
  [[nodiscard]] constexpr bool is_on() const { return is_finite_positive(threshold_sigma); }
  [[nodiscard]] constexpr bool is_outlier(const Innovation& expected) const {
    return expected.residual_rad_s * expected.residual_rad_s >
           threshold_sigma * threshold_sigma * expected.variance_rad2_s2;
  }
  /// Variance that a knock adds until it is decided.
  /// @param square of the newest residual  @param rejected measurements so far
  [[nodiscard]] constexpr float doubt(float square, std::uint16_t rejected) const {
    return square * static_cast<float>(rejected) / static_cast<float>(longest_knock_ticks);
  }
};

}  // namespace zerorate::core
