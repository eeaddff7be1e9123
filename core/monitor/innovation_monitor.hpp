/// @file
/// Does the sensor behave as its model says? Watched by the mean of the normalised innovations.
#pragma once

#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/estimator/prediction.hpp"

namespace zerorate::core {

/// The mean of the normalised innovation squared (NIS) of the last kMemory innovations, the older
/// ones fading. Under the model n of them are together chi-squared with n degrees of freedom, and
/// the cube root of their mean is normal with the mean 1 - 2/(9n) and the variance 2/(9n) (Wilson
/// and Hilferty 1931), so that a few innovations are judged as fairly as many.
///
/// The model is inconsistent while the mean lies outside kDeviations of that normal, either side: a
/// sensor quieter than its model has an interval that is too wide. A single NIS counts no more than
/// kLargest: a knock is reported at once, and forgotten within kMemory innovations.
class InnovationMonitor {
 public:
  struct State {
    float mean_normalised_squared = 1.0F;
    std::uint16_t count = 0;
    bool is_consistent = true;

    constexpr bool operator==(const State&) const = default;
  };

  static constexpr std::uint16_t kMemory = 256;
  static constexpr float kDeviations = 5.0F;  ///< one false alarm in millions of innovations
  static constexpr float kLargest = 200.0F;   ///< alone enough to speak against the model

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }

  /// Cost: a division, a square root and a dozen operations.
  constexpr void observe(const Innovation& innovation) {
    if (!innovation.accepted || innovation.first) return;
    if (state_.count < kMemory) ++state_.count;
    const auto n = static_cast<float>(state_.count);
    const float squared = innovation.normalised_squared();
    state_.mean_normalised_squared +=
        ((squared < kLargest ? squared : kLargest) - state_.mean_normalised_squared) / n;
    state_.is_consistent = is_plausible_mean(state_.mean_normalised_squared, n);
  }

  [[nodiscard]] constexpr bool is_consistent() const { return state_.is_consistent; }

 private:
  [[nodiscard]] static constexpr bool is_plausible_mean(float mean, float n) {
    const float variance = 2.0F / (9.0F * n);
    const float tolerance = kDeviations * square_root(variance);
    const float lowest = 1.0F - variance - tolerance;
    const float highest = 1.0F - variance + tolerance;
    return mean <= highest * highest * highest && mean >= lowest * lowest * lowest;
  }

  State state_;
};

}  // namespace zerorate::core
