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
#include "core/estimator/slow_noise_scale.hpp"
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
  using Scale = core::SlowNoiseScale<kAxes>;

  struct State {
    struct Axis {
      core::InnovationMonitor::State monitor;
      [[no_unique_address]] typename MovingAverage::State moving_average;
      [[no_unique_address]] typename CalibrationMean::State calibration_mean;

      constexpr bool operator==(const Axis&) const = default;
    };
    Filter kalman;  ///< in units of the scale
    typename Scale::State scale;
    std::array<Axis, kAxes> axes;

    constexpr bool operator==(const State&) const = default;
    /// Whether there is a measurement that later ones have confirmed.
    [[nodiscard]] constexpr bool has_learnt() const { return kalman.is_confirmed(); }
  };

  /// @param params must outlive the predictors
  constexpr explicit AxisPredictors(const NodeParams<Shape>& params)
      : coefficients_(params.modes, params.gate, params.temperature),
        kalman_(coefficients_),
        learns_scale_(params.learns_noise && params.modes.is_stationary),
        axes_{Axis{params.modes}, Axis{params.modes}, Axis{params.modes}} {}
  AxisPredictors(const AxisPredictors&) = delete;  // the filter points to its coefficients
  AxisPredictors& operator=(const AxisPredictors&) = delete;
  ~AxisPredictors() = default;

  [[nodiscard]] constexpr State state() const {
    State state{.kalman = kalman_.state(), .scale = scale_.state(), .axes = {}};
    for (std::size_t i = 0; i < kAxes; ++i) {
      state.axes[i] = {.monitor = axes_[i].monitor.state(),
                       .moving_average = axes_[i].moving_average.state(),
                       .calibration_mean = axes_[i].calibration_mean.state()};
    }
    return state;
  }
  constexpr void restore(const State& state) {
    kalman_.restore(state.kalman);
    scale_.restore(state.scale);
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
  /// @param white_variance of their white noise, as learnt
  /// @param model_white_variance the same by the model, against which the innovations are monitored
  constexpr void observe(const Transition& since_last, const Rates& rates_rad_s,
                         float white_variance, float model_white_variance) {
    const bool begins_stop = learns_scale_ && since_last.ticks >= kTicksOfDrive;
    if (begins_stop) end_stop(white_variance / model_white_variance);
    kalman_.advance(since_last);
    const float model_variance = filter().bias_variance + model_white_variance;
    if (begins_stop && filter().is_confirmed()) {
      scale_.begin_stop(biases_rad_s(), filter().bias_variance);
    }
    const float unit = unit_of_variances();
    auto innovations = kalman_.observe(rates_rad_s, white_variance, unit);
    if (learns_scale_) scale_.on_tick(biases_rad_s(), filter().bias_variance);
    const float white = white_variance / unit;
    for (std::size_t i = 0; i < kAxes; ++i) {
      innovations[i].variance_rad2_s2 = model_variance;
      axes_[i].monitor.observe(innovations[i]);
      (void)axes_[i].moving_average.step(since_last, rates_rad_s[i], white);
      (void)axes_[i].calibration_mean.step(since_last, rates_rad_s[i], white);
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
    for (core::Prediction& one : predictions) one.variance_rad2_s2 *= unit_of_variances();
    return predictions;
  }
  [[nodiscard]] constexpr std::array<core::HeadingPrediction, kAxes> predict_heading(
      Predictor which, const Transition& lead, const Transition& drive) const {
    auto headings = of_all_axes(
        which, [&](const auto& predictor) { return predictor.predict_heading(lead, drive); });
    for (core::HeadingPrediction& one : headings) one.variance_rad2 *= unit_of_variances();
    return headings;
  }

  /// The Kalman predictor, in units of scale().
  [[nodiscard]] constexpr const Filter& filter() const { return kalman_.state(); }
  /// How much stronger the slow noise is than the model says.
  [[nodiscard]] constexpr const typename Scale::State& scale() const { return scale_.state(); }
  [[nodiscard]] constexpr bool is_consistent(std::size_t axis) const {
    return axes_[axis].monitor.is_consistent();
  }

  /// Starts the Kalman predictor from what another run learnt; the others begin anew.
  /// Not inlined: what stands on the stack here is gone when the bias is predicted.
  /// @param ticks since its newest measurement
  [[gnu::noinline]] constexpr void resume(const Filter& learnt, const typename Scale::State& scale,
                                          const NodeParams<Shape>& params, std::uint32_t ticks) {
    kalman_.restore(learnt);
    scale_.restore(scale);
    kalman_.advance(Transition{params.modes.over(ticks)});
    kalman_.restart_transients();
    kalman_.inflate_variance(params.turn_on_variance_rad2_s2 / unit_of_variances());
  }

 private:
  /// A pause after which the bias may have wandered: two and a half seconds at the default tick.
  static constexpr std::uint32_t kTicksOfDrive = 5;

  struct Axis {
    core::InnovationMonitor monitor;
    [[no_unique_address]] MovingAverage moving_average;
    [[no_unique_address]] CalibrationMean calibration_mean;

    constexpr explicit Axis(const core::ModesOf<Shape>& modes)
        : moving_average(modes), calibration_mean(modes) {}
  };

  constexpr void end_stop(float white_level) {
    scale_.end_stop(biases_rad_s(), filter().bias_variance);
    if (filter().is_confirmed()) scale_.anchor(white_level);
  }
  [[nodiscard]] constexpr Rates biases_rad_s() const {
    Rates biases{};
    for (std::size_t i = 0; i < kAxes; ++i) {
      const auto& axis = filter().axes[i];
      biases[i] = axis.reference_rad_s + axis.bias_rad_s;
    }
    return biases;
  }
  /// All variances of the predictors are in this unit.
  [[nodiscard]] constexpr float unit_of_variances() const {
    return learns_scale_ ? scale_.cautious_scale() : 1.0F;
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
  Scale scale_;
  bool learns_scale_;
  std::array<Axis, kAxes> axes_;
};

}  // namespace zerorate::app
