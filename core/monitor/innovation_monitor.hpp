/// @file
/// Does the sensor behave as its model says? Watched by the mean of the normalised innovations.
#pragma once

#include <cstdint>

#include "core/estimator/prediction.hpp"

namespace zerorate::core {

/// The exponential mean of the normalised innovation squared (NIS), whose expectation is 1 under
/// the model. Memory: 8 bytes. With the weight 1/n of the newest, the mean behaves like one of
/// 2 n - 1 independent chi-squared(1) values: standard deviation sqrt(2 / (2 n - 1)).
class InnovationMonitor {
 public:
  struct State {
    float mean_normalised_squared = 1.0F;
    std::uint32_t count = 0;
  };

  static constexpr std::uint32_t kMemory = 256;  ///< n: innovations that the mean remembers
  /// Five standard deviations of the mean under the model: 5 sqrt(2 / 511).
  static constexpr float kTolerance = 0.313F;

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }

  constexpr void observe(const Innovation& innovation) {
    if (!innovation.accepted || innovation.first) return;
    if (state_.count < kMemory) ++state_.count;
    state_.mean_normalised_squared +=
        (innovation.normalised_squared() - state_.mean_normalised_squared) /
        static_cast<float>(state_.count);
  }

  /// Until enough has been seen, nothing speaks against the model. A sensor quieter than its model
  /// is as inconsistent as a louder one: its interval is too wide.
  [[nodiscard]] constexpr bool is_consistent() const {
    const float excess = state_.mean_normalised_squared - 1.0F;
    return state_.count < kMemory || (excess <= kTolerance && excess >= -kTolerance);
  }

 private:
  State state_;
};

}  // namespace zerorate::core
