/// @file
/// The strength of the white noise, where it wanders.
#pragma once

#include <algorithm>
#include <cstdint>
#include <type_traits>

#include "core/base/numeric.hpp"
#include "core/samples/sample_model.hpp"

namespace zerorate::core {

/// Variance of a sensor's white noise over its nominal one, followed by a scalar Kalman filter: a
/// Gauss-Markov process around 1, measured by the mean square of n samples, whose relative variance
/// is 2 / n (docs/design/sample-model.md, eq. 5). Cost of a tick: 20 floating-point
/// operations, 3 divisions.
class NoiseLevelTrack {
 public:
  struct State {
    float level = 1.0F;
    float variance = 0.0F;

    constexpr bool operator==(const State&) const = default;
  };
  static_assert(std::is_trivially_copyable_v<State>);

  constexpr explicit NoiseLevelTrack(const NoiseLevel& model)
      : model_(&model), state_{.variance = model.variance} {}
  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }

  /// The factor that the nominal white variance has at the newest tick.
  [[nodiscard]] constexpr float level() const { return state_.level; }

  constexpr void advance(std::uint32_t ticks) {
    if (!model_->is_on()) return;
    const float kept =
        1.0F - one_minus_exp_neg(model_->time_constants_per_tick * static_cast<float>(ticks));
    state_.level = 1.0F + kept * (state_.level - 1.0F);
    state_.variance = model_->variance + kept * kept * (state_.variance - model_->variance);
  }

  /// @param mean_square  of the samples learnt from, over the nominal white variance
  constexpr void observe(float mean_square, float samples) {
    if (!model_->is_on()) return;
    const float noise = 2.0F * state_.level * state_.level / samples;
    const float gain = state_.variance / (state_.variance + noise);
    // Below a tenth the linear filter of a positive number is none: it stays there.
    constexpr float kLeast = 0.1F;
    state_.level = std::max(kLeast, state_.level + gain * (mean_square - state_.level));
    state_.variance *= 1.0F - gain;
  }

 private:
  const NoiseLevel* model_;
  State state_;
};

}  // namespace zerorate::core
