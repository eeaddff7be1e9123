/// @file
/// Mean of the newest standstill, the common method (the paper's eq. 9, "CM").
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/base/numeric.hpp"
#include "core/estimator/prediction.hpp"
#include "core/estimator/weighted_window.hpp"
#include "core/noise/model_shape.hpp"

namespace zerorate::core {

/// Cost: observe 6 operations, bias one division, an interval about 2 log2(count) compositions.
template <ModelShape Shape>
class CalibrationMean {
 public:
  using Coefficients = ModesOf<Shape>;
  using Transition = TransitionOf<Shape>;

  struct State {
    bool restart = true;           ///< the next measurement is the first of a stop
    std::uint32_t count = 0;       ///< measurements of the newest stop
    std::uint32_t age = 0;         ///< ticks from the start to the newest measurement
    float reference_rad_s = 0.0F;  ///< the stop's first measurement
    float sum_rad_s = 0.0F;        ///< sum of the deviations from it
    float lost_rad_s = 0.0F;       ///< rounding error of the sum (Kahan), given back next time
    float white_variance_sum = 0.0F;

    constexpr bool operator==(const State&) const = default;
  };
  static_assert(std::is_trivially_copyable_v<State>);

  /// @param modes noise model of the intervals; must outlive the predictor
  constexpr explicit CalibrationMean(const ModesOf<Shape>& modes) : modes_(&modes) {}

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// True if a restored state is valid.
  [[nodiscard]] static bool is_possible(const State& state) {
    return is_bool(state.restart) && is_plausible(state.sum_rad_s) &&
           is_plausible(state.lost_rad_s) && is_plausible_rate(state.reference_rad_s) &&
           is_plausible_variance(state.white_variance_sum);
  }

  /// The next measurement starts a new mean; until then the old one stands.
  constexpr void begin_stop() { state_.restart = true; }

  constexpr void advance(const Transition& span) { state_.age += span.ticks; }

  constexpr Innovation observe(float rate_rad_s, float white_variance) {
    if (!is_measurement(rate_rad_s, white_variance)) return {};
    if (state_.restart) {
      state_ = {.restart = false, .age = state_.age, .reference_rad_s = rate_rad_s};
    }
    const Innovation innovation{.accepted = true,
                                .first = state_.count == 0,
                                .residual_rad_s = state_.count == 0 ? 0.0F : rate_rad_s - mean()};
    const float addend = (rate_rad_s - state_.reference_rad_s) - state_.lost_rad_s;
    const float sum = state_.sum_rad_s + addend;
    state_.lost_rad_s = (sum - state_.sum_rad_s) - addend;
    state_.sum_rad_s = sum;
    state_.white_variance_sum += white_variance;
    ++state_.count;
    return innovation;
  }

  /// advance() and observe() in one.
  constexpr Innovation step(const Transition& span, float rate_rad_s, float white_variance) {
    advance(span);
    return observe(rate_rad_s, white_variance);
  }

  [[nodiscard]] constexpr float bias_rad_s(const Transition& /*lead*/) const { return mean(); }

  /// Ticks of the measurements that a prediction averages; 0 before the first.
  [[nodiscard]] constexpr std::uint32_t window(const Transition& /*lead*/) const {
    return state_.count;
  }
  [[nodiscard]] constexpr Prediction predict(const Transition& lead) const {
    return predict(lead, modes_->over(state_.count));
  }
  /// @param averaged span of window(lead) ticks
  [[nodiscard]] constexpr Prediction predict(const Transition& lead,
                                             const Transition& averaged) const {
    if (state_.count == 0) return {};
    return {mean(), weighted(averaged, 1.0F / count()).point_variance(lead)};
  }

  [[nodiscard]] constexpr HeadingPrediction predict_heading(const Transition& lead,
                                                            const Transition& drive) const {
    if (state_.count == 0) return {};
    const auto ticks = static_cast<float>(drive.ticks);
    const float tick_s = modes_->tick.in_seconds();
    return {mean() * ticks * tick_s,
            weighted(modes_->over(state_.count), ticks / count()).sum_variance(lead, drive) *
                tick_s * tick_s};
  }

 private:
  [[nodiscard]] constexpr float count() const { return static_cast<float>(state_.count); }
  [[nodiscard]] constexpr float mean() const {
    return state_.count == 0 ? 0.0F : state_.reference_rad_s + state_.sum_rad_s / count();
  }
  [[nodiscard]] constexpr WeightedWindow<Shape> weighted(const Transition& averaged,
                                                         float weight) const {
    WeightedWindow<Shape> window{*modes_, state_.age - state_.count};
    window.add(averaged, weight, state_.white_variance_sum / count());
    return window;
  }

  const ModesOf<Shape>* modes_;
  State state_{};
};

template <std::size_t R, std::size_t C>
CalibrationMean(const Modes<R, C>&) -> CalibrationMean<ModelShape{.decaying = R, .rotating = C}>;

}  // namespace zerorate::core
