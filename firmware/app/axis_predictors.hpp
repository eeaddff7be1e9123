/// @file
/// The predictors of a sensor's axes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "core/estimator/bias_predictor.hpp"
#include "core/estimator/calibration_mean.hpp"
#include "core/estimator/drive_scale.hpp"
#include "core/estimator/kalman_bank.hpp"
#include "core/estimator/moving_average.hpp"
#include "core/monitor/innovation_monitor.hpp"
#include "firmware/app/learnt_noise.hpp"
#include "firmware/app/node_params.hpp"
#include "firmware/app/possible_state.hpp"

namespace zerorate::app {

/// Predictors of all axes, fed alike, and monitors of the Kalman predictor's innovations.
template <ModelShape Shape, NodeCapacity Capacity>
class AxisPredictors {
 public:
  static constexpr std::size_t kAxes = 3;
  using Rates = std::array<float, kAxes>;
  using Transition = core::FilterTransition<Shape>;
  using Kalman = core::KalmanBank<Shape, kAxes>;
  using MovingAverage = std::conditional_t<Capacity.runs_moving_average,
                                           core::MovingAverage<Shape, Capacity.average_levels>,
                                           core::NoPredictor<Shape>>;
  using CalibrationMean =
      std::conditional_t<Capacity.runs_calibration_mean, core::CalibrationMean<Shape>,
                         core::NoPredictor<Shape>>;
  using Filter = typename Kalman::State;
  static constexpr bool kLearns = Kalman::kLearns;
  /// Place of the scale where the model is taken at its word.
  struct NoDriveScale {
    struct Memory {
      constexpr bool operator==(const Memory&) const = default;
    };
    struct State {
      [[no_unique_address]] Memory memory;

      constexpr bool operator==(const State&) const = default;
    };
    [[nodiscard]] constexpr State state() const { return {}; }
    template <class Anything>
    constexpr void restore(const Anything& /*nothing*/) {}
    template <class Anything>
    [[nodiscard]] static constexpr bool is_possible(const Anything& /*nothing*/) {
      return true;
    }
  };
  using DriveScale = std::conditional_t<kLearns, core::DriveScale<Kalman>, NoDriveScale>;
  /// Levels that a filter's figures are relative to.
  struct Levels {
    float white = 0.0F;  ///< noise that the learnt scales rest on, over the model's; 0: not seen
    [[no_unique_address]] typename DriveScale::Memory drive;

    constexpr bool operator==(const Levels&) const = default;
  };

  struct State {
    struct Axis {
      core::InnovationMonitor::State monitor;
      [[no_unique_address]] typename MovingAverage::State moving_average;
      [[no_unique_address]] typename CalibrationMean::State calibration_mean;

      constexpr bool operator==(const Axis&) const = default;
    };
    Filter kalman;
    float white_level = 0.0F;  ///< that the learnt scales are relative to; 0: not seen yet
    bool knows_white = false;  ///< that level stays
    float stops = 0.0F;        ///< that were learnt from, older ones counted in part
    [[no_unique_address]] typename DriveScale::State drive_scale;
    std::array<Axis, kAxes> axes;

    constexpr bool operator==(const State&) const = default;
    [[nodiscard]] constexpr Levels levels() const {
      return {.white = white_level, .drive = drive_scale.memory};
    }
    /// Whether there is a measurement that later ones have confirmed.
    [[nodiscard]] constexpr bool has_learnt() const { return kalman.is_confirmed(); }
  };

  /// @param params must outlive the predictors
  constexpr explicit AxisPredictors(const NodeParams<Shape>& params)
      : coefficients_(params.modes, params.gate, params.temperature, params.hypotheses),
        kalman_(coefficients_),
        axes_{Axis{params.modes}, Axis{params.modes}, Axis{params.modes}} {}
  AxisPredictors(const AxisPredictors&) = delete;  // the filter points to its coefficients
  AxisPredictors& operator=(const AxisPredictors&) = delete;
  ~AxisPredictors() = default;

  [[nodiscard]] constexpr State state() const {
    State state{.kalman = kalman_.state(),
                .white_level = white_level_,
                .knows_white = knows_white_,
                .stops = stops_,
                .drive_scale = drive_scale_.state(),
                .axes = {}};
    for (std::size_t i = 0; i < kAxes; ++i) {
      state.axes[i] = {.monitor = axes_[i].monitor.state(),
                       .moving_average = axes_[i].moving_average.state(),
                       .calibration_mean = axes_[i].calibration_mean.state()};
    }
    return state;
  }
  constexpr void restore(const State& state) {
    kalman_.restore(state.kalman);
    white_level_ = state.white_level;
    knows_white_ = state.knows_white;
    stops_ = state.stops;
    drive_scale_.restore(state.drive_scale);
    for (std::size_t i = 0; i < kAxes; ++i) {
      axes_[i].monitor.restore(state.axes[i].monitor);
      axes_[i].moving_average.restore(state.axes[i].moving_average);
      axes_[i].calibration_mean.restore(state.axes[i].calibration_mean);
    }
  }

  /// Whether memory from outside may be what a node remembers while the power is off.
  [[nodiscard]] bool is_possible(const Filter& filter, const Levels& levels) const {
    return core::is_plausible_variance(levels.white) && DriveScale::is_possible(levels.drive) &&
           is_possible_bank<Kalman>(filter, learns() ? coefficients_.hypotheses->count : 0);
  }
  /// Whether memory from outside may be such a state.
  [[nodiscard]] bool is_possible(const State& state) const {
    bool are_possible =
        core::is_bool(state.knows_white) && core::is_plausible_variance(state.stops) &&
        DriveScale::is_possible(state.drive_scale) && is_possible(state.kalman, state.levels());
    for (const auto& axis : state.axes) {
      are_possible = are_possible && core::InnovationMonitor::is_possible(axis.monitor) &&
                     MovingAverage::is_possible(axis.moving_average) &&
                     CalibrationMean::is_possible(axis.calibration_mean);
    }
    return are_possible;
  }

  /// Predictors without memory across stops start again.
  constexpr void begin_stop() {
    ++stops_;
    if constexpr (kLearns) {
      drive_scale_.end_stop(kalman_.state());
      stop_begins_ = has_learnt();
    }
    for (Axis& axis : axes_) {
      axis.moving_average.begin_stop();
      axis.calibration_mean.begin_stop();
    }
  }
  /// Time passes by `since_last`, at the end of which the rates are measured.
  constexpr void observe(const Transition& since_last, const Rates& rates_rad_s,
                         const WhiteNoise& white) {
    if (learns() && white.is_seen && !knows_white_) follow_white_level(white);
    kalman_.advance(since_last);
    if constexpr (kLearns) {
      stops_ *= coefficients_.hypotheses->kept;
      if (stop_begins_ && learns()) drive_scale_.begin_stop(kalman_.state());
      stop_begins_ = false;
    }
    auto innovations = kalman_.observe(rates_rad_s, white.variance(level_of(white)));
    if constexpr (kLearns)
      drive_scale_.on_tick(kalman_.state());  // of a stop that did not begin: nothing
    for (std::size_t i = 0; i < kAxes; ++i) {
      if (!learns()) {  // the monitor asks whether the model is right, not what was made of it
        innovations[i].variance_rad2_s2 +=
            white.variance(white.model_level) - white.variance(white.level);
      }
      const float own = white.variance(white.level) / slow_level(i);
      axes_[i].monitor.observe(innovations[i]);
      (void)axes_[i].moving_average.step(since_last, rates_rad_s[i], own);
      (void)axes_[i].calibration_mean.step(since_last, rates_rad_s[i], own);
    }
  }

  [[nodiscard]] constexpr float bias_rad_s(Predictor which, std::size_t axis,
                                           const Transition& lead) const {
    switch (which) {
      case Predictor::moving_average:
        return axes_[axis].moving_average.bias_rad_s(lead);
      case Predictor::calibration_mean:
        return axes_[axis].calibration_mean.bias_rad_s(lead);
      case Predictor::kalman:
        break;
    }
    return kalman_.bias_rad_s(lead, axis);
  }
  [[nodiscard]] constexpr std::array<core::Prediction, kAxes> predict(
      Predictor which, const Transition& lead) const {
    auto predictions =
        of_all_axes(which, [&](const auto& predictor) { return predictor.predict(lead); });
    if (which == Predictor::kalman && !learns()) return predictions;
    for (std::size_t i = 0; i < kAxes; ++i) predictions[i].variance_rad2_s2 *= level_of(which, i);
    return predictions;
  }
  [[nodiscard]] constexpr std::array<core::HeadingPrediction, kAxes> predict_heading(
      Predictor which, const Transition& lead, const Transition& drive) const {
    auto headings = of_all_axes(
        which, [&](const auto& predictor) { return predictor.predict_heading(lead, drive); });
    if (which == Predictor::kalman && !learns()) return headings;
    for (std::size_t i = 0; i < kAxes; ++i) headings[i].variance_rad2 *= level_of(which, i);
    return headings;
  }

  /// The Kalman predictor as of the newest measurement: worth keeping while the power is off, with
  /// its levels, if has_learnt(). The other predictors begin anew at the next stop.
  [[nodiscard]] constexpr const Filter& filter() const { return kalman_.state(); }
  [[nodiscard]] constexpr Levels levels() const {
    return {.white = white_level_, .drive = drive_scale_.state().memory};
  }
  /// Whether there is a measurement that later ones have confirmed.
  [[nodiscard]] constexpr bool has_learnt() const { return filter().is_confirmed(); }
  /// Noise of an axis as it was learnt.
  [[nodiscard]] constexpr LearntNoise learnt_noise(std::size_t axis) const {
    return app::learnt_noise(kalman_, axis, stops_);
  }
  [[nodiscard]] constexpr bool is_consistent(std::size_t axis) const {
    if constexpr (kLearns) {
      if (drive_scale_.is_exceeded()) return false;
    }
    return axes_[axis].monitor.is_consistent();
  }

  /// Starts the Kalman predictor from what another run learnt; the others begin anew.
  /// Not inlined: what stands on the stack here is gone when the bias is predicted.
  /// @param ticks since its newest measurement
  [[gnu::noinline]] void resume(const NodeParams<Shape>& params, std::uint32_t ticks,
                                std::span<const std::uint8_t, sizeof(Filter)> learnt,
                                const Levels& levels) {
    kalman_.restore(learnt);
    white_level_ = levels.white;
    knows_white_ = levels.white > 0.0F;  // else no window of a stop has shown it
    drive_scale_.restore(levels.drive);
    pass_pause(params, ticks);
  }
  /// Starts the Kalman predictor from biases that another model learnt; all its noise is learnt
  /// anew.
  [[gnu::noinline]] void resume(const NodeParams<Shape>& params, std::uint32_t ticks,
                                const Rates& biases_rad_s, float variance_rad2_s2) {
    kalman_.start_from(biases_rad_s, variance_rad2_s2);
    pass_pause(params, ticks);
  }

  /// Ages what is known by ticks that were not measured, and adds what the bias changes by while
  /// the power is off. The other predictors begin anew.
  [[gnu::noinline]] constexpr void report_pause(const NodeParams<Shape>& params,
                                                std::uint32_t ticks, bool has_lost_power) {
    if (!filter().is_measured()) return;
    kalman_.advance(Transition{params.modes.over(ticks)});
    if (has_lost_power) {
      kalman_.restart_transients();
      kalman_.inflate_variance(params.turn_on_variance_or_widest());
    }
    for (Axis& axis : axes_) {
      axis.moving_average.begin_stop();
      axis.calibration_mean.begin_stop();
    }
  }

  /// Variance of the white noise of a tick, as learnt.
  [[nodiscard]] constexpr float white_variance(const WhiteNoise& white, std::size_t axis) const {
    if (!learns()) return white.variance(white.level);
    return white.variance(level_of(white)) *
           kalman_.expected(axis, 1.0F, [](const auto& /*one*/, float scale) { return scale; });
  }

 private:
  /// Factor of the white noise that is more than its estimate's error: the sensor is shaken, or no
  /// longer.
  static constexpr float kChanged = 2.0F;

  struct Axis {
    core::InnovationMonitor monitor;
    [[no_unique_address]] MovingAverage moving_average;
    [[no_unique_address]] CalibrationMean calibration_mean;

    constexpr explicit Axis(const core::ModesOf<Shape>& modes)
        : monitor(modes.tick), moving_average(modes), calibration_mean(modes) {}
  };

  /// Ages what is known by so many ticks without power.
  constexpr void pass_pause(const NodeParams<Shape>& params, std::uint32_t ticks) {
    kalman_.advance(Transition{params.modes.over(ticks)});
    kalman_.restart_transients();
    kalman_.inflate_variance(params.turn_on_variance_rad2_s2);
  }

  [[nodiscard]] constexpr bool learns() const {
    return kLearns && coefficients_.hypotheses->count > 0;
  }
  /// White noise over that which the model's is taken to be: a learning bank has its own scale.
  [[nodiscard]] constexpr float level_of(const WhiteNoise& white) const {
    if (!learns()) return white.level;
    if (!white.is_known || !knows_white_) return 1.0F;
    const float change = white.level / white_level_;
    return change < kChanged && change * kChanged > 1.0F ? 1.0F : change;
  }
  /// The scales are relative to the white noise of the first half minute, as well as it is known.
  constexpr void follow_white_level(const WhiteNoise& white) {
    if (white_level_ == 0.0F) {
      kalman_.start_learning(white.level);
    } else {
      kalman_.rescale(white.level / white_level_);
    }
    white_level_ = white.level;
    knows_white_ = white.is_known;
  }
  /// Factor of the variances that a predictor gives: a bank has its own scales, of which the drives
  /// have shown what they are worth.
  [[nodiscard]] constexpr float level_of(Predictor which, std::size_t axis) const {
    if (which != Predictor::kalman) return slow_level(axis);
    if constexpr (kLearns) {
      return drive_scale_.scale();
    } else {
      return 1.0F;
    }
  }
  /// How much stronger the slow noise is than the model says.
  [[nodiscard]] constexpr float slow_level(std::size_t axis) const {
    return kalman_.expected(axis, 1.0F,
                            [](const auto& one, float scale) { return scale * one.level; });
  }

  /// Answers of action(predictor) for all axes: of a bank at once, of the others one by one.
  template <class Action>
  [[nodiscard]] constexpr auto of_all_axes(Predictor which, Action action) const {
    switch (which) {
      case Predictor::moving_average:
        return std::array{action(axes_[0].moving_average), action(axes_[1].moving_average),
                          action(axes_[2].moving_average)};
      case Predictor::calibration_mean:
        return std::array{action(axes_[0].calibration_mean), action(axes_[1].calibration_mean),
                          action(axes_[2].calibration_mean)};
      case Predictor::kalman:
        break;
    }
    return action(kalman_);
  }

  typename Kalman::Coefficients coefficients_;
  Kalman kalman_;
  float white_level_ = 0.0F;
  bool knows_white_ = false;
  float stops_ = 0.0F;
  bool stop_begins_ = false;
  [[no_unique_address]] DriveScale drive_scale_;
  std::array<Axis, kAxes> axes_;
};

}  // namespace zerorate::app
