/// @file
/// Forecasts of any predictor at any time, also in the middle of a tick's work.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/estimator/prediction.hpp"
#include "firmware/app/node_params.hpp"
#include "firmware/app/tick_work.hpp"

namespace zerorate::app {

/// Answers from what a TickNode has learnt so far. While a measurement is being learnt, the filters
/// of some hypotheses stand at its tick and the others at the measurement before: each forecasts
/// from where it stands.
/// @tparam Ticks a TickNode
template <class Ticks>
class TickForecast {
 public:
  using Transition = typename Ticks::Transition;
  using InputTrack = typename Ticks::InputTrack;
  using Lead = typename Ticks::Lead;

  /// @param ticks must outlive the forecast
  constexpr explicit TickForecast(const Ticks& ticks) : ticks_(ticks) {}

  /// Bias that a predictor expects at the end of the tick being filled.
  [[nodiscard]] constexpr float bias_rad_s(Predictor which, std::size_t axis) const {
    if (which == Predictor::calibration_mean) {  // A mean is the same at any time, without a span.
      return ticks_.predictors().bias_rad_s(which, axis, {ticks_.lead(), ticks_.lead()});
    }
    return with_lead(
        [&](const Lead& lead) { return ticks_.predictors().bias_rad_s(which, axis, lead); });
  }
  [[nodiscard]] constexpr core::Prediction predict(Predictor which, std::size_t axis) const {
    return with_lead(
        [&](const Lead& lead) { return ticks_.predictors().predict(which, axis, lead, modes()); });
  }
  /// Predicted integral of the bias over the ticks from `first` to before `last`.
  /// @param first, last not before measured_ticks()
  [[nodiscard]] constexpr core::HeadingPrediction predict_heading(Predictor which, std::size_t axis,
                                                                  std::uint32_t first,
                                                                  std::uint32_t last) const {
    const auto& modes = this->modes();
    const std::uint32_t behind = first - ticks_.measured_ticks();
    const Transition others{modes.over(behind)};
    Transition drive{modes.over(last - first)};
    const std::uint32_t now = std::clamp(ticks_.tick() + 1, first, last);
    typename InputTrack::Lead to_now{.ticks = ticks_.ticks_since_measured()};
    ticks_.inputs().fill_lead(to_now.ticks, to_now);
    InputTrack::over_drive(to_now, now - first, drive);
    if (!is_advancing()) {
      return ticks_.predictors().predict_heading(which, axis, {others, others}, drive);
    }
    const Transition advanced{modes.over(behind - std::min(behind, ticks_.work().span.ticks))};
    return ticks_.predictors().predict_heading(which, axis, {others, advanced, advanced_filters()},
                                               drive);
  }

  /// Variance of what is added to the bias for as long as the vehicle keeps its heading and the
  /// bias its place within a step: the Earth's rate, and the rounding of the samples.
  [[nodiscard]] constexpr float constant_variance_rad2_s2(std::size_t axis) const {
    return ticks_.earth().heading_variance_rad2_s2[axis] +
           ticks_.white().rounding().variance_rad2_s2(axis);
  }

 private:
  [[nodiscard]] constexpr const auto& modes() const { return ticks_.params().model.modes; }
  /// Whether some filters stand at the measurement before and others, or none, at the newest.
  [[nodiscard]] constexpr bool is_advancing() const {
    return ticks_.work().stage == TickStage::span || ticks_.work().stage == TickStage::advance;
  }
  [[nodiscard]] constexpr std::size_t advanced_filters() const {
    return ticks_.work().stage == TickStage::advance ? ticks_.work().item : 0;
  }
  /// Calls use(lead) with the spans to the end of the tick being filled, which are at hand until a
  /// tick is learnt.
  template <class Use>
  [[nodiscard]] constexpr auto with_lead(Use use) const {
    const auto& modes = this->modes();
    const std::uint32_t ticks = ticks_.ticks_since_measured();
    if (!ticks_.is_busy() && ticks_.lead().ticks == ticks)
      return use(Lead{ticks_.lead(), ticks_.lead()});
    Transition others{modes.over(ticks)};
    ticks_.inputs().fill_lead(ticks, others);
    if (!is_advancing()) return use(Lead{others, others});
    Transition advanced{modes.over(ticks - ticks_.work().span.ticks)};
    ticks_.inputs().fill_lead(advanced.ticks, advanced);
    InputTrack::prepend(ticks_.work().span, others);
    return use(Lead{others, advanced, advanced_filters()});
  }

  const Ticks& ticks_;
};

}  // namespace zerorate::app
