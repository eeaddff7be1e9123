/// @file
/// The strength of the slow noise of a sensor, learnt from stop to stop.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/base/numeric.hpp"

namespace zerorate::core {

/// Factor of the variances of a model's slow noise, by maximum likelihood in fixed memory
/// (docs/adr/0017).
///
/// The model says how the bias wanders from one stop to the next; by how much is a guess of a data
/// sheet. A stop moves the estimate by d, whose variance is s k: k, by how much the stop reduced
/// the variance in units of s. The logarithm of s follows the score f (d^2 / (s k) - 1) / 2 over
/// the information gathered; f = k / (variance before) is the share of the variance that the stop
/// resolved. A stop too short to tell anything has f near 0.
///
/// Before anything is known of the slow noise, it is taken to differ from the model by the square
/// root of the factor by which the white noise does: half way between a data sheet that is right
/// about the one and one that is right about their ratio.
///
/// Cost of a stop: some 30 floating-point operations and 4 divisions.
template <std::size_t Axes>
class SlowNoiseScale {
 public:
  using Rates = std::array<float, Axes>;

  struct State {
    float scale = 1.0F;
    float information = kPriorInformation;  ///< about the logarithm of the scale
    Rates before_rad_s{};                   ///< the biases predicted when the stop began
    float variance_before = 0.0F;           ///< of each, in units of the scale
    std::uint8_t ticks_left = 0;            ///< of the stop, until it is judged; 0: no stop
    bool is_anchored = false;               ///< to the white noise

    constexpr bool operator==(const State&) const = default;
  };
  static_assert(std::is_trivially_copyable_v<State>);

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }

  [[nodiscard]] constexpr float scale() const { return state_.scale; }
  /// Scale with its uncertainty: about the mean of a scale whose logarithm is normal.
  [[nodiscard]] constexpr float cautious_scale() const {
    return state_.scale * (1.0F + 0.5F / state_.information);
  }

  /// The first stop is over.
  /// @param white_level variance of the white noise over that of the model
  constexpr void anchor(float white_level) {
    if (state_.is_anchored) return;
    state_.is_anchored = true;
    if (is_finite_positive(white_level)) state_.scale *= square_root(white_level);
  }

  /// A stop begins, for which the biases are predicted with this variance, in units of the scale.
  constexpr void begin_stop(const Rates& bias_rad_s, float variance) {
    state_.before_rad_s = bias_rad_s;
    state_.variance_before = variance;
    state_.ticks_left = kTicks;
  }
  /// A tick of the stop was learnt from. The drift of a long stop says nothing of the drive.
  constexpr void on_tick(const Rates& bias_rad_s, float variance) {
    if (state_.ticks_left == 1) {
      end_stop(bias_rad_s, variance);
    } else if (state_.ticks_left > 0) {
      --state_.ticks_left;
    }
  }
  /// The stop is over: learns from it, if on_tick() has not.
  constexpr void end_stop(const Rates& bias_rad_s, float variance) {
    if (state_.ticks_left == 0) return;
    state_.ticks_left = 0;
    const float resolved = state_.variance_before - variance;
    if (!is_finite_positive(resolved)) return;
    const float share = resolved / state_.variance_before;
    const float inverse = 1.0F / (state_.scale * resolved);
    float excess = 0.0F;
    float axes = 0.0F;
    for (std::size_t i = 0; i < Axes; ++i) {
      const float moved = bias_rad_s[i] - state_.before_rad_s[i];
      if (moved == 0.0F) continue;  // an axis without any noise is not there
      excess += std::min(moved * moved * inverse, kLargest) - 1.0F;
      axes += 1.0F;
    }
    constexpr float kHalf = 0.5F;
    state_.information =
        std::min(state_.information + kHalf * axes * share * share, kMostInformation);
    const float step = kHalf * share * excess / state_.information;
    state_.scale *= 1.0F + std::clamp(step, kLargestFall, kLargestRise);
  }

 private:
  static constexpr float kPriorInformation = 0.25F;  ///< a factor of 7 either way
  static constexpr float kMostInformation = 60.0F;   ///< memory of some forty stops
  static constexpr std::uint8_t kTicks = 20;
  static constexpr float kLargest = 16.0F;  ///< one stop that went wrong is not the noise
  static constexpr float kLargestRise = 3.0F;
  static constexpr float kLargestFall = -0.5F;

  State state_{};
};

}  // namespace zerorate::core
