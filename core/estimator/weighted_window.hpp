/// @file
/// The error of a weighted mean of past measurements as a predictor, in closed form per mode.
///
/// The paper leaves the intervals of the suboptimal predictors as future work; this is them. The
/// derivation stands in docs/design/window-intervals.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/noise/model_shape.hpp"

namespace zerorate::core {

namespace detail {

/// One mode inside WeightedWindow. With M the weight so far and z the mode now, E = M z - sum of
/// the weighted contributions is what the mode adds to the predictor's error.
template <class Scalar>
struct WindowMode {
  float variance = 0.0F;  ///< Var Re z
  Scalar cross{};         ///< E[E conj(z)] / 2
  float error = 0.0F;     ///< Var Re E

  /// A segment with the weight `w` on each tick; `before` = M before it.
  constexpr void add(const ModeTransition<Scalar>& span, float ticks, float before, float w) {
    const Scalar after{before + w * ticks};
    const Scalar kept = Scalar{1.0F} - span.one_minus_phi_m;
    // E' = E + from_z z + after n - w N
    const Scalar from_z = Scalar{-before} * span.one_minus_phi_m +
                          Scalar{w} * (span.sum_lag - Scalar{ticks} * span.one_minus_phi_m);
    error += 2.0F * real_part(conjugate(from_z) * cross) + squared_magnitude(from_z) * variance +
             squared_magnitude(after) * span.noise -
             2.0F * w * real_part(after * conjugate(span.sum_covariance)) +
             w * w * span.sum_variance;
    cross = conjugate(kept) * (cross + from_z * Scalar{variance}) + after * Scalar{span.noise} -
            Scalar{w} * span.sum_covariance;
    variance = variance_after(span, variance);
  }

  /// Variance of E + (what follows the window), which depends on z by -from_z.
  [[nodiscard]] constexpr float error_with(Scalar from_z, float noise_after) const {
    return error - 2.0F * real_part(conjugate(from_z) * cross) +
           squared_magnitude(from_z) * variance + noise_after;
  }
};

}  // namespace detail

/// Collects the variance of [weighted mean of a window] - [bias after it]. Segments are added from
/// the oldest tick to the newest; each costs about 30 R + 100 C operations.
template <ModelShape Shape>
class WeightedWindow {
 public:
  using Transition = TransitionOf<Shape>;

  /// @param age ticks from the start of the sensor's noise (Modes::initial_variance) to the window
  constexpr WeightedWindow(const ModesOf<Shape>& modes, std::uint32_t age) {
    for (std::size_t i = 0; i < Shape.decaying; ++i) {
      // A mean ignores the expected transient, which therefore counts as error.
      const float mean = modes.decaying[i].initial_mean;
      decaying_[i].variance = modes.decaying[i].initial_variance + mean * mean;
    }
    for (std::size_t i = 0; i < Shape.rotating; ++i)
      rotating_[i].variance = modes.rotating[i].initial_variance;
    if (modes.is_stationary) return;  // age changes nothing
    const Transition before = modes.over(age);
    for (std::size_t i = 0; i < Shape.decaying; ++i) {
      decaying_[i].variance = variance_after(before.decaying[i], decaying_[i].variance);
    }
    for (std::size_t i = 0; i < Shape.rotating; ++i) {
      rotating_[i].variance = variance_after(before.rotating[i], rotating_[i].variance);
    }
  }

  /// @param weight of each tick of the segment
  /// @param white_variance of the measurement of one tick [rad2/s2]
  constexpr void add(const Transition& segment, float weight, float white_variance) {
    const auto ticks = static_cast<float>(segment.ticks);
    level_.add(segment.level, ticks, total_weight_, weight);
    for (std::size_t i = 0; i < Shape.decaying; ++i) {
      decaying_[i].add(segment.decaying[i], ticks, total_weight_, weight);
    }
    for (std::size_t i = 0; i < Shape.rotating; ++i) {
      rotating_[i].add(segment.rotating[i], ticks, total_weight_, weight);
    }
    total_weight_ += weight * ticks;
    white_ += weight * weight * ticks * white_variance;
  }

  /// Error variance of the window's mean as the bias `lead` after it; the weights sum to 1.
  [[nodiscard]] constexpr float point_variance(const Transition& lead) const {
    float variance = white_ + level_.error_with(0.0F, lead.level.noise);
    for (std::size_t i = 0; i < Shape.decaying; ++i) {
      variance += decaying_[i].error_with(lead.decaying[i].one_minus_phi_m, lead.decaying[i].noise);
    }
    for (std::size_t i = 0; i < Shape.rotating; ++i) {
      variance += rotating_[i].error_with(lead.rotating[i].one_minus_phi_m, lead.rotating[i].noise);
    }
    return variance;
  }

  /// Error variance of the window's weighted sum as the sum of the bias over `drive`, which begins
  /// `lead` after the window; the weights sum to drive.ticks. [rad2/s2 ticks2]
  [[nodiscard]] constexpr float sum_variance(const Transition& lead,
                                             const Transition& drive) const {
    const auto ticks = static_cast<float>(drive.ticks);
    float variance = white_ + sum_error(level_, lead.level, drive.level, ticks);
    for (std::size_t i = 0; i < Shape.decaying; ++i) {
      variance += sum_error(decaying_[i], lead.decaying[i], drive.decaying[i], ticks);
    }
    for (std::size_t i = 0; i < Shape.rotating; ++i) {
      variance += sum_error(rotating_[i], lead.rotating[i], drive.rotating[i], ticks);
    }
    return variance;
  }

 private:
  template <class Scalar>
  [[nodiscard]] static constexpr float sum_error(const detail::WindowMode<Scalar>& mode,
                                                 const ModeTransition<Scalar>& lead,
                                                 const ModeTransition<Scalar>& drive, float ticks) {
    const Scalar from_z = Scalar{ticks} * lead.one_minus_phi_m +
                          (Scalar{1.0F} - lead.one_minus_phi_m) * drive.sum_lag;
    return mode.error_with(from_z,
                           squared_magnitude(drive.sum_gain) * lead.noise + drive.sum_variance);
  }

  detail::WindowMode<float> level_;
  std::array<detail::WindowMode<float>, Shape.decaying> decaying_{};
  std::array<detail::WindowMode<Complex>, Shape.rotating> rotating_{};
  float total_weight_ = 0.0F;
  float white_ = 0.0F;
};

}  // namespace zerorate::core
