/// @file
/// Selection of the samples of a tick to learn from, and the strength of their noise.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "core/base/numeric.hpp"
#include "core/samples/sample_model.hpp"

namespace zerorate::core {

/// Samples of one axis against their prediction under core::SampleModel: each is undisturbed, an
/// outlier, or moved. The last two are not learnt from. Whether it moves is a hidden Markov chain;
/// while it does, the offset is followed by a scalar Kalman filter, and what has just begun is
/// merged with what goes on (interacting multiple models: Blom and Bar-Shalom 1988).
/// docs/design/sample-model.md, eq. 2 to 5.
///
/// A rotation that lasts longer than kLongest mean lengths is a change of the bias: its samples are
/// learnt from until they agree with the prediction again.
///
/// Cost of a sample: some 60 floating-point operations, 8 divisions, 2 square roots and 2
/// exponentials. Fixed memory; not re-entrant.
class SampleScreen {
 public:
  static constexpr float kLongest = 16.0F;  // exp(-16) of all rotations last longer

  struct State {
    float moved = 0.0F;            ///< probability that the newest sample was moved
    float offset_rad_s = 0.0F;     ///< expected, if it was
    float offset_variance = 0.0F;  ///< variance of that offset
    float disturbed = 0.0F;  ///< samples without an undisturbed one, in mean lengths of a motion
    float expected_rad_s = 0.0F;  ///< the bias of this tick by its samples so far
    float variance = std::numeric_limits<float>::infinity();  ///< infinite: nothing is expected
    float white_variance = 1.0F;  ///< white variance of a sample of this tick
    float squares_rad2_s2 =
        0.0F;  ///< sum over the samples learnt from: of residuals, as of white noise

    constexpr bool operator==(const State&) const = default;
  };
  static_assert(std::is_trivially_copyable_v<State>);

  /// Distribution of the next sample: the bias with its white noise, plus, with probability
  /// `moved`, an offset, or else, with probability `outlier`, an outlier's.
  struct Forecast {
    float expected_rad_s = 0.0F;
    float variance = 0.0F;  ///< white noise included
    float outlier = 0.0F;
    float outlier_variance = 0.0F;  ///< in addition
    float moved = 0.0F;
    float offset_rad_s = 0.0F;
    float offset_variance = 0.0F;  ///< in addition
  };

  constexpr explicit SampleScreen(const SampleModel& model) : model_(&model) {}
  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// Whether memory from outside may be such a state. An infinite variance: nothing is expected.
  [[nodiscard]] static constexpr bool is_possible(const State& state) {
    const bool is_share = state.moved >= 0.0F && state.moved <= 1.0F;
    return is_share && is_plausible(state.offset_rad_s) &&
           is_plausible_variance(state.offset_variance) && is_plausible_variance(state.disturbed) &&
           is_plausible_rate(state.expected_rad_s) &&
           (state.variance == std::numeric_limits<float>::infinity() ||
            is_plausible_variance(state.variance)) &&
           state.white_variance > 0.0F && is_plausible(state.white_variance) &&
           is_plausible_variance(state.squares_rad2_s2);
  }

  /// The vehicle moves: nothing is known of a rotation before, and nothing is looked at until the
  /// next tick.
  constexpr void end_stop() { state_ = {}; }

  /// A tick begins.
  /// @param expected_rad_s, variance  the bias that the predictor expects in this tick; infinite
  ///   where it has not been calibrated: then every sample is learnt from
  /// @param white_variance  of a sample
  constexpr void begin_tick(float expected_rad_s, float variance, float white_variance) {
    state_.expected_rad_s = expected_rad_s;
    state_.variance = variance;
    state_.white_variance = white_variance;
    state_.squares_rad2_s2 = 0.0F;
  }

  [[nodiscard]] constexpr Forecast forecast() const {
    const MotionEvents& motion = model_->motion;
    Forecast next{.expected_rad_s = state_.expected_rad_s,
                  .variance = state_.variance + state_.white_variance,
                  .outlier = model_->outliers.probability,
                  .outlier_variance = model_->outliers.variance_rad2_s2};
    if (!motion.is_on()) return next;
    const float kept = 1.0F - motion.end_probability;
    const float goes_on = state_.moved * kept;
    next.moved = goes_on + (1.0F - state_.moved) * motion.begin_probability;
    const float share = next.moved > 0.0F ? goes_on / next.moved : 0.0F;
    const float offset = kept * state_.offset_rad_s;
    const float known = kept * kept * (state_.offset_variance - motion.variance_rad2_s2);
    next.offset_rad_s = share * offset;
    next.offset_variance =
        motion.variance_rad2_s2 + share * (known + (1.0F - share) * offset * offset);
    return next;
  }

  /// The next sample. Whether it may be learnt from.
  constexpr bool take(float rate_rad_s) {
    if (!is_finite(state_.variance)) return true;
    const Forecast next = forecast();
    const float residual = rate_rad_s - next.expected_rad_s;
    const float off = residual - next.offset_rad_s;
    const float moved_variance = next.variance + next.offset_variance;
    const Shares shares = shares_of(next, residual, off, moved_variance);
    follow_motion(next, shares.moved, off, moved_variance);
    const bool agrees = shares.undisturbed >= 0.5F;
    state_.disturbed = agrees ? 0.0F : state_.disturbed + model_->motion.end_probability;
    const bool is_learnt = agrees || state_.disturbed > kLongest;
    if (is_learnt) learn(residual, next.variance);
    return is_learnt;
  }

  /// Squares of the samples learnt from in this tick: their sum estimates the white variance as
  /// many times.
  [[nodiscard]] constexpr float squares_rad2_s2() const { return state_.squares_rad2_s2; }

 private:
  /// Probabilities of what the newest sample was, by Bayes' rule.
  struct Shares {
    float undisturbed;
    float moved;
  };
  /// exp(-x) as 1 - one_minus_exp_neg(x) is exact to 1e-7 of the largest weight, which has x = 0.
  static constexpr float weight(float prior, float narrowing, float excess) {
    return prior * square_root(narrowing) * (1.0F - one_minus_exp_neg(0.5F * excess));
  }
  static constexpr Shares shares_of(const Forecast& next, float residual, float off,
                                    float moved_variance) {
    struct Part {
      float prior;
      float variance;
      float square;
    };
    const float still = 1.0F - next.moved;
    const float wild_variance = next.variance + next.outlier_variance;
    const std::array parts{Part{still * (1.0F - next.outlier), next.variance, residual * residual},
                           Part{still * next.outlier, wild_variance, residual * residual},
                           Part{next.moved, moved_variance, off * off}};
    std::array<float, 3> weights{};
    float least = std::numeric_limits<float>::infinity();
    for (const Part& part : parts) least = std::min(least, part.square / part.variance);
    float sum = 0.0F;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const Part& part = parts[i];
      weights[i] =
          weight(part.prior, next.variance / part.variance, part.square / part.variance - least);
      sum += weights[i];
    }
    return {weights[0] / sum, weights[2] / sum};
  }

  constexpr void follow_motion(const Forecast& next, float moved, float off, float variance) {
    if (!model_->motion.is_on()) return;
    const float gain = next.offset_variance / variance;
    state_.moved = moved;
    state_.offset_rad_s = next.offset_rad_s + gain * off;
    state_.offset_variance = gain * next.variance;
  }

  constexpr void learn(float residual, float variance) {
    const float white_share = state_.white_variance / variance;
    state_.squares_rad2_s2 += residual * residual * white_share;
    state_.expected_rad_s += (1.0F - white_share) * residual;
    state_.variance *= white_share;
  }

  const SampleModel* model_;
  State state_{};
};

}  // namespace zerorate::core
