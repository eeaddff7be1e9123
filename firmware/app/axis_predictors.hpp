/// @file
/// The predictors of a sensor's axes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/estimator/calibration_mean.hpp"
#include "core/estimator/kalman_bank.hpp"
#include "core/estimator/moving_average.hpp"
#include "core/estimator/no_predictor.hpp"
#include "core/monitor/innovation_monitor.hpp"
#include "firmware/app/node_params.hpp"

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

  struct State {
    struct Axis {
      core::InnovationMonitor::State monitor;
      [[no_unique_address]] typename MovingAverage::State moving_average;
      [[no_unique_address]] typename CalibrationMean::State calibration_mean;

      constexpr bool operator==(const Axis&) const = default;
    };
    Filter kalman;
    std::array<Axis, kAxes> axes;

    constexpr bool operator==(const State&) const = default;
    /// Whether there is a measurement that later ones have confirmed.
    [[nodiscard]] constexpr bool has_learnt() const { return kalman.is_confirmed(); }
  };

  /// @param params must outlive the predictors
  constexpr explicit AxisPredictors(const NodeParams<Shape>& params)
      : coefficients_(params.modes, params.gate, params.temperature),
        kalman_(coefficients_),
        axes_{Axis{params.modes}, Axis{params.modes}, Axis{params.modes}} {}
  AxisPredictors(const AxisPredictors&) = delete;  // the filter points to its coefficients
  AxisPredictors& operator=(const AxisPredictors&) = delete;
  ~AxisPredictors() = default;

  [[nodiscard]] constexpr State state() const {
    State state{.kalman = kalman_.state(), .axes = {}};
    for (std::size_t i = 0; i < kAxes; ++i) {
      state.axes[i] = {.monitor = axes_[i].monitor.state(),
                       .moving_average = axes_[i].moving_average.state(),
                       .calibration_mean = axes_[i].calibration_mean.state()};
    }
    return state;
  }
  constexpr void restore(const State& state) {
    kalman_.restore(state.kalman);
    for (std::size_t i = 0; i < kAxes; ++i) {
      axes_[i].monitor.restore(state.axes[i].monitor);
      axes_[i].moving_average.restore(state.axes[i].moving_average);
      axes_[i].calibration_mean.restore(state.axes[i].calibration_mean);
    }
  }

  /// Predictors without memory across stops start again.
  constexpr void begin_stop() {
    for (Axis& axis : axes_) {
      axis.moving_average.begin_stop();
      axis.calibration_mean.begin_stop();
    }
  }
  /// Time passes by `since_last`, at the end of which the rates are measured.
  constexpr void observe(const Transition& since_last, const Rates& rates_rad_s,
                         float white_variance) {
    kalman_.advance(since_last);
    const auto innovations = kalman_.observe(rates_rad_s, white_variance);
    for (std::size_t i = 0; i < kAxes; ++i) {
      axes_[i].monitor.observe(innovations[i]);
      (void)axes_[i].moving_average.step(since_last, rates_rad_s[i], white_variance);
      (void)axes_[i].calibration_mean.step(since_last, rates_rad_s[i], white_variance);
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
    return of_all_axes(which, [&](const auto& predictor) { return predictor.predict(lead); });
  }
  [[nodiscard]] constexpr std::array<core::HeadingPrediction, kAxes> predict_heading(
      Predictor which, const Transition& lead, const Transition& drive) const {
    return of_all_axes(
        which, [&](const auto& predictor) { return predictor.predict_heading(lead, drive); });
  }

  [[nodiscard]] constexpr const Filter& filter() const { return kalman_.state(); }
  [[nodiscard]] constexpr bool is_consistent(std::size_t axis) const {
    return axes_[axis].monitor.is_consistent();
  }

  /// Starts the Kalman predictor from what another run learnt; the others begin anew.
  /// Not inlined: what stands on the stack here is gone when the bias is predicted.
  /// @param ticks since its newest measurement
  [[gnu::noinline]] constexpr void resume(const Filter& learnt, const NodeParams<Shape>& params,
                                          std::uint32_t ticks) {
    kalman_.restore(learnt);
    kalman_.advance(Transition{params.modes.over(ticks)});
    kalman_.restart_transients();
    kalman_.inflate_variance(params.turn_on_variance_rad2_s2);
  }

 private:
  struct Axis {
    core::InnovationMonitor monitor;
    [[no_unique_address]] MovingAverage moving_average;
    [[no_unique_address]] CalibrationMean calibration_mean;

    constexpr explicit Axis(const core::ModesOf<Shape>& modes)
        : moving_average(modes), calibration_mean(modes) {}
  };

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
  std::array<Axis, kAxes> axes_;
};

}  // namespace zerorate::app
