/// @file
/// Variance of the integral of the bias over the drive so far, cut into steps.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/app/node_params.hpp"
#include "firmware/app/tick_work.hpp"

namespace zerorate::app {

/// Steps of a TickNode behind its prediction, where the variance of a drive was asked for. The same
/// figures as TickForecast::predict_heading(), a piece or a hypothesis at a time.
/// @tparam Ticks a TickNode
template <class Ticks>
class DriveIntegralSteps {
 public:
  using Params = typename Ticks::Params;
  using Predictors = typename Ticks::Predictors;
  using Transition = typename Ticks::Transition;
  using Work = typename Ticks::Work;

  /// @param lead span to the tick being filled; the steps leave another one there
  constexpr DriveIntegralSteps(const Params& params, const Predictors& predictors, Transition& lead,
                               Work& work)
      : params_(params), predictors_(predictors), lead_(lead), work_(work) {}

  /// Does one step of the stages drive, approach and integral.
  constexpr void step() {
    switch (work_.stage) {
      case TickStage::drive:
        return step_drive();
      case TickStage::approach:
        params_.model.modes.make_piece(work_.item, lead_);
        return work_.next(Ticks::kPieces, TickStage::integral);
      default:
        step_integral();
        if (work_.stage == TickStage::idle) answer();
    }
  }

 private:
  constexpr void step_drive() {
    if (work_.item == 0) {
      work_.span.ticks = std::min(work_.drive.ticks, lead_.ticks);
      Ticks::InputTrack::over_drive(lead_, work_.span.ticks, work_.span);
    }
    params_.model.modes.make_piece(work_.item, work_.span);
    work_.next(Ticks::kPieces, TickStage::approach);
    if (work_.stage != TickStage::approach) return;
    const std::uint32_t ticks = lead_.ticks - work_.span.ticks;
    lead_ = {};
    lead_.ticks = ticks;
  }
  constexpr void step_integral() {
    if (params_.published != Predictor::kalman) {
      const typename Ticks::Lead lead{lead_, lead_};
      const auto heading =
          predictors_.predict_heading(params_.published, work_.item, lead, work_.span);
      work_.drive.variance_rad2[work_.item] = heading.variance_rad2;
      return work_.next(Ticks::kAxes, TickStage::idle);
    }
    const auto forecast = predictors_.bank().forecast();
    if (work_.item == 0) work_.mixtures = {};
    forecast.add_integral(work_.mixtures, work_.item, lead_, work_.span);
    work_.next(forecast.count(), TickStage::idle);
    if (work_.stage != TickStage::idle) return;
    const auto headings = forecast.integrals_of(work_.mixtures, work_.span.ticks);
    for (std::size_t i = 0; i < Ticks::kAxes; ++i) {
      work_.drive.variance_rad2[i] = headings[i].variance_rad2 * predictors_.drive_scale();
    }
  }
  constexpr void answer() {
    work_.drive.ticks = 0;
    work_.drive.is_known = true;
    lead_.ticks = 0;
  }

  const Params& params_;
  const Predictors& predictors_;
  Transition& lead_;
  Work& work_;
};

}  // namespace zerorate::app
