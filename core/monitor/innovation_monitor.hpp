/// @file
/// Does the sensor behave as its model says? Watched by the mean of the normalised innovations.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"
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
///
/// A filter with short ticks forgets those within seconds, and what it learnt from them stays. So
/// the word is withdrawn no sooner than kShortest after the last implausible mean, less kMemory
/// innovations. A mean near its bound crosses it to and fro: there are at least kFewest plausible
/// means before.
class InnovationMonitor {
 public:
  struct State {
    float mean_normalised_squared = 1.0F;
    std::uint16_t count = 0;
    std::uint16_t doubted = 0;  ///< plausible means until the model is consistent again

    constexpr bool operator==(const State&) const = default;
  };

  static constexpr std::uint16_t kMemory = 256;
  static constexpr float kDeviations = 5.0F;  ///< one false alarm in millions of innovations
  static constexpr float kLargest = 200.0F;   ///< alone enough to speak against the model
  static constexpr Duration kShortest = Duration::seconds(128);
  static constexpr std::uint16_t kFewest = 64;

  constexpr InnovationMonitor() = default;
  /// @param tick of the filter, at least so long as to give an innovation
  constexpr explicit InnovationMonitor(Duration tick)
      : hold_(static_cast<std::uint16_t>(
            std::clamp(kShortest / tick - kMemory, std::int64_t{kFewest}, std::int64_t{0xFFFF}))) {}

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// Whether memory from outside may be such a state.
  [[nodiscard]] static constexpr bool is_possible(const State& state) {
    return state.mean_normalised_squared >= 0.0F && state.mean_normalised_squared <= kLargest &&
           state.count <= kMemory;
  }

  /// Cost: a division, a square root and a dozen operations.
  constexpr void observe(const Innovation& innovation) {
    if (!innovation.accepted || innovation.first) return;
    if (state_.count < kMemory) ++state_.count;
    const auto n = static_cast<float>(state_.count);
    const float squared = innovation.normalised_squared();
    state_.mean_normalised_squared +=
        ((squared < kLargest ? squared : kLargest) - state_.mean_normalised_squared) / n;
    if (!is_plausible_mean(state_.mean_normalised_squared, n)) {
      state_.doubted = hold_;
    } else if (state_.doubted > 0) {
      --state_.doubted;
    }
  }

  [[nodiscard]] constexpr bool is_consistent() const { return state_.doubted == 0; }

 private:
  [[nodiscard]] static constexpr bool is_plausible_mean(float mean, float n) {
    const float variance = 2.0F / (9.0F * n);
    const float tolerance = kDeviations * square_root(variance);
    const float lowest = 1.0F - variance - tolerance;
    const float highest = 1.0F - variance + tolerance;
    return mean <= highest * highest * highest && mean >= lowest * lowest * lowest;
  }

  std::uint16_t hold_ = kFewest;  ///< plausible means after which a doubt is over
  State state_;
};

}  // namespace zerorate::core
