/// @file
/// The predictors of a sensor's axes.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/estimator/calibration_mean.hpp"
#include "core/estimator/kalman_predictor.hpp"
#include "core/estimator/moving_average.hpp"
#include "core/monitor/innovation_monitor.hpp"
#include "firmware/app/node_params.hpp"

namespace zerorate::app {

/// Predictors of all axes, fed alike, and a monitor of the Kalman predictor's innovations.
template <ModelShape Shape, NodeCapacity Capacity>
class AxisPredictors {
 public:
  static constexpr std::size_t kAxes = 3;
  using Modes = core::ModesOf<Shape>;
  using Transition = core::FilterTransition<Shape>;
  using Kalman = core::KalmanPredictor<Shape>;
  using MovingAverage = core::MovingAverage<Shape, Capacity.average_levels>;
  using CalibrationMean = core::CalibrationMean<Shape>;
  using Filter = typename Kalman::State;

  struct AxisState {
    Filter kalman;
    typename MovingAverage::State moving_average;
    typename CalibrationMean::State calibration_mean;
    core::InnovationMonitor::State monitor;

    constexpr bool operator==(const AxisState&) const = default;
  };
  using State = std::array<AxisState, kAxes>;

  /// @param params must outlive the predictors
  constexpr explicit AxisPredictors(const NodeParams<Shape>& params)
      : coefficients_(params.modes, params.gate, params.temperature),
        axes_{Axis{params.modes, coefficients_}, Axis{params.modes, coefficients_},
              Axis{params.modes, coefficients_}} {}
  AxisPredictors(const AxisPredictors&) = delete;  // its axes point into it
  AxisPredictors& operator=(const AxisPredictors&) = delete;
  ~AxisPredictors() = default;

  [[nodiscard]] constexpr State state() const {
    State state;
    for (std::size_t i = 0; i < kAxes; ++i) {
      state[i] = {.kalman = axes_[i].kalman.state(),
                  .moving_average = axes_[i].moving_average.state(),
                  .calibration_mean = axes_[i].calibration_mean.state(),
                  .monitor = axes_[i].monitor.state()};
    }
    return state;
  }
  constexpr void restore(const State& state) {
    for (std::size_t i = 0; i < kAxes; ++i) {
      axes_[i].kalman.restore(state[i].kalman);
      axes_[i].moving_average.restore(state[i].moving_average);
      axes_[i].calibration_mean.restore(state[i].calibration_mean);
      axes_[i].monitor.restore(state[i].monitor);
    }
  }

  constexpr void begin_stop() {
    for (Axis& axis : axes_) {
      axis.kalman.begin_stop();
      axis.moving_average.begin_stop();
      axis.calibration_mean.begin_stop();
    }
  }
  /// Time passes by `since_last`, at the end of which the rate of an axis is measured.
  constexpr void observe(std::size_t i, const Transition& since_last, float rate_rad_s,
                         float white_variance) {
    Axis& axis = axes_[i];
    axis.monitor.observe(axis.kalman.step(since_last, rate_rad_s, white_variance));
    (void)axis.moving_average.step(since_last, rate_rad_s, white_variance);
    (void)axis.calibration_mean.step(since_last, rate_rad_s, white_variance);
  }

  /// Calls action(predictor) with the predictor of an axis.
  template <class Action>
  constexpr auto visit(Predictor which, std::size_t i, Action action) const {
    switch (which) {
      case Predictor::moving_average:
        return action(axes_[i].moving_average);
      case Predictor::calibration_mean:
        return action(axes_[i].calibration_mean);
      case Predictor::kalman:
        break;
    }
    return action(axes_[i].kalman);
  }

  [[nodiscard]] constexpr const Filter& filter(std::size_t axis) const {
    return axes_[axis].kalman.state();
  }
  [[nodiscard]] constexpr bool is_consistent(std::size_t axis) const {
    return axes_[axis].monitor.is_consistent();
  }
  /// Whether each axis has a measurement that later ones have confirmed.
  [[nodiscard]] constexpr bool has_learnt() const {
    return std::all_of(axes_.begin(), axes_.end(),
                       [](const Axis& axis) { return axis.kalman.state().is_confirmed(); });
  }
  [[nodiscard]] static constexpr bool has_learnt(const State& state) {
    return std::all_of(state.begin(), state.end(),
                       [](const AxisState& axis) { return axis.kalman.is_confirmed(); });
  }

  /// Starts the Kalman predictors from what another run learnt; the others begin anew.
  /// @param filter_of gives the filter of an axis: one at a time, to spare the stack
  /// @param off time since its newest measurement
  template <class FilterOf>
  void resume(FilterOf filter_of, const Transition& off, float turn_on_variance_rad2_s2) {
    for (std::size_t i = 0; i < kAxes; ++i) {
      axes_[i].kalman.restore(filter_of(i));
      axes_[i].kalman.advance(off);
      axes_[i].kalman.restart_transients();
      axes_[i].kalman.inflate_variance(turn_on_variance_rad2_s2);
    }
  }

 private:
  struct Axis {
    Kalman kalman;
    MovingAverage moving_average;
    CalibrationMean calibration_mean;
    core::InnovationMonitor monitor;

    constexpr Axis(const Modes& modes, const typename Kalman::Coefficients& coefficients)
        : kalman(coefficients), moving_average(modes), calibration_mean(modes) {}
  };

  typename Kalman::Coefficients coefficients_;
  std::array<Axis, kAxes> axes_;
};

}  // namespace zerorate::app
