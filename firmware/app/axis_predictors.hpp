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
  static constexpr std::size_t kAxes = Capacity.axes;
  using Rates = std::array<float, kAxes>;
  using Transition = core::FilterTransition<Shape>;
  using Kalman = core::KalmanBank<Shape, kAxes>;
  using Lead = typename Kalman::Lead;
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
  using Innovations = typename Kalman::Innovations;

  struct State {
    struct Axis {
      core::InnovationMonitor::State monitor;
      [[no_unique_address]] typename MovingAverage::State moving_average;
      [[no_unique_address]] typename CalibrationMean::State calibration_mean;

      constexpr bool operator==(const Axis&) const = default;
    };
    Filter kalman;
    float stops = 0.0F;  ///< stops that were learnt from, older ones counted in part
    [[no_unique_address]] typename DriveScale::State drive_scale;
    std::array<Axis, kAxes> axes;

    constexpr bool operator==(const State&) const = default;
  };
  /// One measurement, and the variance of its white noise as each of those who use it sees it.
  struct Measurement {
    Rates rate_rad_s{};
    float white_of_bank = 0.0F;   ///< relative to the level that the bank's scales rest on
    float white = 0.0F;           ///< level of this sensor
    float white_of_model = 0.0F;  ///< level of the model
    Innovations innovations{};    ///< innovations of the bank, once it has compared

    constexpr bool operator==(const Measurement&) const = default;
  };

  /// @param params must outlive the predictors
  constexpr explicit AxisPredictors(const NodeParams<Shape>& params)
      : coefficients_(params.model.modes, params.model.gate, params.model.inputs,
                      params.model.hypotheses),
        kalman_(coefficients_),
        axes_(core::filled_array<kAxes>(Axis{params.model.modes})) {}
  AxisPredictors(const AxisPredictors&) = delete;  // the filter points to its coefficients
  AxisPredictors& operator=(const AxisPredictors&) = delete;
  ~AxisPredictors() = default;

  [[nodiscard]] constexpr State state() const {
    State state{.kalman = kalman_.state(),
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
    stops_ = state.stops;
    drive_scale_.restore(state.drive_scale);
    for (std::size_t i = 0; i < kAxes; ++i) {
      axes_[i].monitor.restore(state.axes[i].monitor);
      axes_[i].moving_average.restore(state.axes[i].moving_average);
      axes_[i].calibration_mean.restore(state.axes[i].calibration_mean);
    }
  }

  /// True if restored memory of the time without power is valid.
  [[nodiscard]] bool is_possible(const Filter& filter,
                                 const typename DriveScale::Memory& drive) const {
    return DriveScale::is_possible(drive) &&
           is_possible_bank<Kalman>(filter, learns() ? coefficients_.hypotheses->count : 0);
  }
  /// True if a restored state is valid.
  [[nodiscard]] bool is_possible(const State& state) const {
    bool are_possible = core::is_plausible_variance(state.stops) &&
                        DriveScale::is_possible(state.drive_scale) &&
                        is_possible(state.kalman, state.drive_scale.memory);
    for (const auto& axis : state.axes) {
      are_possible = are_possible && core::InnovationMonitor::is_possible(axis.monitor) &&
                     MovingAverage::is_possible(axis.moving_average) &&
                     CalibrationMean::is_possible(axis.calibration_mean);
    }
    return are_possible;
  }

  // A measurement passes these in turn: begin(), bank().advance() for each hypothesis, compare(),
  // and where that is true learn() for each hypothesis and conclude(), bank().weigh() for each
  // axis; at the end observe_rest().

  /// @param tick whether it begins a stop, or a level that jumped; as in compare()
  constexpr void begin(const auto& tick) {
    if (tick.begins_stop) {
      ++stops_;
      if constexpr (kLearns) drive_scale_.end_stop(kalman_.state());
    }
    if (tick.begins_stop || tick.has_jumped) begin_averages();
  }
  /// Predictors without memory across stops start again.
  constexpr void begin_averages() {
    for (Axis& axis : axes_) {
      axis.moving_average.begin_stop();
      axis.calibration_mean.begin_stop();
    }
  }
  /// The bank compares the measurement with its forecast.
  /// @return true if it is to learn it
  constexpr bool compare(Measurement& measurement, const auto& tick, const Transition& since_last) {
    if constexpr (kLearns) {
      stops_ *= coefficients_.hypotheses->kept;
      if (tick.begins_stop && learns() && has_learnt()) {
        drive_scale_.begin_stop(kalman_.state(), since_last);
      }
    }
    const bool is_to_learn = kalman_.compare(measurement.rate_rad_s, measurement.white_of_bank,
                                             tick.has_jumped, measurement.innovations);
    if (tick.is_sway) kalman_.confirm();
    return is_to_learn;
  }
  constexpr void learn(std::size_t m, const Measurement& measurement) {
    kalman_.learn(m, measurement.rate_rad_s, measurement.white_of_bank, measurement.innovations);
  }
  /// Everything but the bank: drive scale, monitors, moving average and calibration mean.
  constexpr void observe_rest(const Transition& since_last, const Measurement& measurement) {
    if constexpr (kLearns) drive_scale_.on_tick(kalman_.state());
    for (std::size_t i = 0; i < kAxes; ++i) {
      core::Innovation innovation = measurement.innovations[i];
      // The monitor judges the model itself, not the white noise that was measured in its place.
      if (!learns()) {
        innovation.variance_rad2_s2 += measurement.white_of_model - measurement.white;
      }
      axes_[i].monitor.observe(innovation);
      if constexpr (Capacity.runs_moving_average || Capacity.runs_calibration_mean) {
        const float white = measurement.white / slow_level(i);
        (void)axes_[i].moving_average.step(since_last, measurement.rate_rad_s[i], white);
        (void)axes_[i].calibration_mean.step(since_last, measurement.rate_rad_s[i], white);
      }
    }
  }

  [[nodiscard]] constexpr Kalman& bank() { return kalman_; }
  [[nodiscard]] constexpr const Kalman& bank() const { return kalman_; }
  /// True if the noise is learnt: there are hypotheses.
  [[nodiscard]] constexpr bool learns() const { return kalman_.is_learning(); }

  /// Window of the newest measurements that a prediction of an axis needs the span of, in ticks.
  [[nodiscard]] constexpr std::uint32_t window(Predictor which, const Transition& lead) const {
    switch (which) {
      case Predictor::moving_average:
        return axes_[0].moving_average.window(lead);
      case Predictor::calibration_mean:
        return axes_[0].calibration_mean.window(lead);
      case Predictor::kalman:
        break;
    }
    return 0;
  }
  /// Prediction of an axis by one of the predictors without a bank.
  /// @param window span of that many ticks
  [[nodiscard]] constexpr core::Prediction predict(Predictor which, std::size_t axis,
                                                   const Transition& lead,
                                                   const core::TransitionOf<Shape>& window) const {
    core::Prediction prediction = which == Predictor::moving_average
                                      ? axes_[axis].moving_average.predict(lead, window)
                                      : axes_[axis].calibration_mean.predict(lead, window);
    prediction.variance_rad2_s2 *= slow_level(axis);
    return prediction;
  }
  /// Factor of the variances that the bank predicts, by what the drives have shown.
  [[nodiscard]] constexpr float drive_scale() const {
    if constexpr (kLearns) return learns() ? drive_scale_.scale() : 1.0F;
    return 1.0F;
  }

  /// Bias of an axis.
  /// @param lead spans from the newest measurement of each filter; the other predictors stand at
  ///   `lead.others`
  [[nodiscard]] constexpr float bias_rad_s(Predictor which, std::size_t axis,
                                           const Lead& lead) const {
    switch (which) {
      case Predictor::moving_average:
        return axes_[axis].moving_average.bias_rad_s(lead.others);
      case Predictor::calibration_mean:
        return axes_[axis].calibration_mean.bias_rad_s(lead.others);
      case Predictor::kalman:
        break;
    }
    return kalman_.forecast().bias_rad_s(lead, axis);
  }
  [[nodiscard]] constexpr core::Prediction predict(Predictor which, std::size_t axis,
                                                   const Lead& lead,
                                                   const core::ModesOf<Shape>& modes) const {
    if (which != Predictor::kalman) {
      return predict(which, axis, lead.others, modes.over(window(which, lead.others)));
    }
    core::Prediction prediction = kalman_.forecast().predict(lead)[axis];
    prediction.variance_rad2_s2 *= drive_scale();
    return prediction;
  }
  [[nodiscard]] constexpr core::HeadingPrediction predict_heading(Predictor which, std::size_t axis,
                                                                  const Lead& lead,
                                                                  const Transition& drive) const {
    core::HeadingPrediction heading;
    switch (which) {
      case Predictor::moving_average:
        heading = axes_[axis].moving_average.predict_heading(lead.others, drive);
        break;
      case Predictor::calibration_mean:
        heading = axes_[axis].calibration_mean.predict_heading(lead.others, drive);
        break;
      case Predictor::kalman:
        heading = kalman_.forecast().predict_heading(lead, drive)[axis];
        heading.variance_rad2 *= drive_scale();
        return heading;
    }
    heading.variance_rad2 *= slow_level(axis);
    return heading;
  }

  /// The Kalman predictor as of the newest measurement: worth keeping while the power is off, with
  /// its drive scale, if has_learnt(). The other predictors begin anew at the next stop.
  [[nodiscard]] constexpr const Filter& filter() const { return kalman_.state(); }
  [[nodiscard]] constexpr typename DriveScale::Memory drive_memory() const {
    return drive_scale_.state().memory;
  }
  /// True if later measurements have confirmed one.
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
  [[gnu::noinline]] void resume(std::span<const std::uint8_t, sizeof(Filter)> learnt,
                                const typename DriveScale::Memory& drive) {
    kalman_.restore(learnt);
    drive_scale_.restore(drive);
  }
  /// Starts the Kalman predictor from biases that another model learnt; all its noise is learnt
  /// anew.
  [[gnu::noinline]] void resume(const Rates& biases_rad_s, float variance_rad2_s2) {
    kalman_.start_from(biases_rad_s, variance_rad2_s2);
  }
  /// Ages what is known by ticks that were not measured. The averages begin anew.
  /// @param turn_on_variance_rad2_s2 variance of the change of the bias; negative: the power stayed
  ///   on
  [[gnu::noinline]] constexpr void pass_pause(const Transition& pause,
                                              float turn_on_variance_rad2_s2) {
    if (!filter().is_measured()) return;
    kalman_.advance(pause);
    if (turn_on_variance_rad2_s2 >= 0.0F) {
      kalman_.restart_transients();
      kalman_.inflate_variance(turn_on_variance_rad2_s2);
    }
    begin_averages();
  }

 private:
  struct Axis {
    core::InnovationMonitor monitor;
    [[no_unique_address]] MovingAverage moving_average;
    [[no_unique_address]] CalibrationMean calibration_mean;

    constexpr explicit Axis(const core::ModesOf<Shape>& modes)
        : monitor(modes.tick), moving_average(modes), calibration_mean(modes) {}
  };

  /// Slow noise over the model's.
  [[nodiscard]] constexpr float slow_level(std::size_t axis) const {
    return kalman_.expected(axis, 1.0F,
                            [](const auto& one, float scale) { return scale * one.level; });
  }

  typename Kalman::Coefficients coefficients_;
  Kalman kalman_;
  float stops_ = 0.0F;
  [[no_unique_address]] DriveScale drive_scale_;
  std::array<Axis, kAxes> axes_;
};

}  // namespace zerorate::app
