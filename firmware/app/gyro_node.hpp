/// @file
/// The node: samples and odometer pulses in, bias-corrected rate with its interval out.
///
/// This is the one step function of the project. The MCU image, the Linux daemon, a replay on a PC
/// and the likelihood that identifies a model all call GyroNode::step.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "core/base/result.hpp"
#include "core/estimator/calibration_mean.hpp"
#include "core/estimator/gate.hpp"
#include "core/estimator/kalman_predictor.hpp"
#include "core/estimator/moving_average.hpp"
#include "core/monitor/innovation_monitor.hpp"
#include "core/monitor/odometer_check.hpp"
#include "core/noise/temperature_drift.hpp"
#include "core/samples/tick_average.hpp"
#include "core/standstill/hold_back_line.hpp"
#include "core/standstill/standstill.hpp"
#include "core/temperature/temperature_track.hpp"
#include "drivers/common/gyro_source.hpp"
#include "firmware/app/rate_message.hpp"
#include "firmware/app/sample_screening.hpp"

namespace zerorate::app {

enum class Predictor : std::uint8_t { kalman, moving_average, calibration_mean };
inline constexpr std::size_t kPredictors = 3;

/// Why parameters cannot be used.
enum class ParamsError : std::uint8_t {
  tick_not_positive,
  tick_shorter_than_sample,
  white_variance_not_positive,
  negative_time,
  no_room_for_samples,  ///< a model of single samples, and NodeCapacity::screens_samples is false
  hold_back_too_long,   ///< more than GyroNode::kHeldTicks ticks: slow the filter or shorten it
};

/// What a node is built from. R decaying and C rotating modes as in core::Modes; K weights of the
/// temperature as in core::TemperatureBlock, 0 for a node that does not look at it.
template <std::size_t R, std::size_t C, std::size_t K = 0>
struct NodeParams {
  core::Modes<R, C> modes;                          ///< the slow noise at the filter's tick
  float white_variance_rad2_s2 = 0.0F;              ///< of one sensor sample
  float measurement_floor_variance_rad2_s2 = 0.0F;  ///< of a mean, however many samples it is of
  /// What the bias changes by while the power is off; infinite: unknown, nothing is worth keeping.
  float turn_on_variance_rad2_s2 = std::numeric_limits<float>::infinity();
  core::Gate gate;  ///< of the Kalman predictor; off by default
  /// What the Kalman predictor knows of it.
  [[no_unique_address]] core::TemperatureBlock<K> temperature{};
  core::SampleModel samples{};   ///< of single samples; off by default
  core::Duration sample_period;  ///< nominal; the stamps of the samples decide
  core::Standstill::Params standstill;
  core::OdometerCheck::Params odometer;
  Predictor published = Predictor::kalman;  ///< whose bias corrects the rate
};

/// How much a node remembers, for boards that count bytes. The results are the same as long as
/// nothing is beyond it.
struct NodeCapacity {
  std::size_t held_ticks = 64;      ///< of the hold-back line, 32 bytes each
  std::size_t average_levels = 22;  ///< of core::SuffixSums, 50 bytes each on every axis
  /// Room for NodeParams::samples: 60 bytes an axis, and 12 for each held tick.
  bool screens_samples = false;
};

/// One sensor with three axes. Chip-free and board-free; no heap; one thread (the caller's).
/// Cost per sample: a few additions; per tick: see the predictors.
template <std::size_t R, std::size_t C, std::size_t K = 0, NodeCapacity Capacity = NodeCapacity{}>
class GyroNode {
 public:
  static constexpr std::size_t kAxes = 3;
  static constexpr std::size_t kHeldTicks = Capacity.held_ticks;
  static constexpr bool kScreensSamples = Capacity.screens_samples;
  using Params = NodeParams<R, C, K>;
  using Span = core::FilterTransition<R, C, K>;
  using TickTemperature = core::TickTemperature<K>;
  using Screening = SampleScreening<kAxes, Capacity.screens_samples>;
  /// A measurement that waits until it is certain that the vehicle stood.
  struct HeldTick : core::TickMean<kAxes> {
    [[no_unique_address]] TickTemperature temperature;
    [[no_unique_address]] typename Screening::Squares squares;
  };
  using HoldBack = core::HoldBackLine<HeldTick, kHeldTicks>;

  using Filter = typename core::KalmanPredictor<R, C, K>::State;
  struct AxisState {
    Filter kalman;
    typename core::MovingAverage<R, C, Capacity.average_levels>::State moving_average;
    typename core::CalibrationMean<R, C>::State calibration_mean;
    core::InnovationMonitor::State monitor;
  };
  /// Everything the node remembers; restored into a node with the same parameters it continues
  /// bit for bit.
  struct State {
    core::Instant newest_sample;
    bool has_sample = false;
    bool stop_open = false;            ///< measurements now belong to the stop of the last one
    bool odometer_fault = false;       ///< not yet published
    std::uint32_t measured_ticks = 0;  ///< ticks up to and with the newest measurement
    Span lead;                         ///< from there to the tick being filled
    core::Standstill::State standstill;
    core::OdometerCheck::State odometer;
    typename core::TickAverage<kAxes>::State average;
    HoldBack held;
    [[no_unique_address]] typename core::TemperatureTrack<K>::State temperature;
    [[no_unique_address]] typename Screening::State screening;
    std::array<AxisState, kAxes> axes;
  };
  static_assert(std::is_trivially_copyable_v<State>);

  [[nodiscard]] static constexpr core::Result<void, ParamsError> check(const Params& params);

  /// @param params must pass check() and outlive the node
  constexpr explicit GyroNode(const Params& params)
      : params_(params),
        one_tick_(params.modes.one_tick()),
        standstill_(params.standstill),
        odometer_(params.odometer, params.modes.tick, params.sample_period,
                  params.white_variance_rad2_s2),
        average_(params.modes.tick, params.sample_period),
        temperature_(params.temperature),
        screening_(params.samples),
        coefficients_(params.modes, params.gate, params.temperature),
        axes_{Axis{params.modes, coefficients_}, Axis{params.modes, coefficients_},
              Axis{params.modes, coefficients_}} {
    ZERORATE_ASSERT(check(params).has_value());
  }
  GyroNode(const GyroNode&) = delete;  // its axes point into it
  GyroNode& operator=(const GyroNode&) = delete;
  ~GyroNode() = default;

  /// An odometer pulse. Before step() with a sample that is not older.
  constexpr void pulse(core::Instant at) {
    // What is certain by now belongs to the stop that ends here; learnt later it would be taken for
    // a stop of its own, and the predictors without memory would start again from it.
    if (learn_until(standstill_.discard_after(at))) predict_tick();
    held_.discard_after(standstill_.discard_after(at));
    odometer_.pulse(at - standstill_.state().last_pulse);
    end_stop(at);
  }

  /// The odometer input dropped edges; that it was moving is known, but not since when: nothing
  /// that is held back is certain any more.
  constexpr void report_odometer_fault(core::Instant now) {
    odometer_fault_ = true;
    held_.clear();
    end_stop(now);
  }

  /// One sample. Samples must come in the order of their time stamps; one that is not newer than
  /// the one before, or not finite, is refused with a flag and changes nothing.
  constexpr RateMessage step(const drivers::GyroSample& sample);

  /// What is known while the gyro gives no samples: a message without a rate, the bias and its
  /// interval as of the newest sample, and no claim that the vehicle stands.
  constexpr RateMessage step_without_sample(core::Instant now);

  /// The bias that a predictor expects at the newest sample.
  [[nodiscard]] constexpr core::AngularRate bias(Predictor which, std::size_t axis) const {
    return core::rad_per_s(
        axes_[axis].visit(which, [&](const auto& p) { return p.bias_rad_s(lead_); }));
  }
  /// The same with its variance.
  [[nodiscard]] constexpr core::Prediction predict(Predictor which, std::size_t axis) const {
    return axes_[axis].visit(which, [&](const auto& p) { return p.predict(lead_); });
  }
  /// The integral of the bias from one time to a later one, neither before the newest measurement,
  /// as far as it was predictable then; times count in whole ticks.
  [[nodiscard]] constexpr core::HeadingPrediction predict_heading(Predictor which, std::size_t axis,
                                                                  core::Instant from,
                                                                  core::Instant to) const {
    const std::uint32_t first = std::max(average_.tick_of(from), measured_ticks_);
    const std::uint32_t last = std::max(average_.tick_of(to), first);
    const Span lead{params_.modes.over(first - measured_ticks_)};
    Span drive{params_.modes.over(last - first)};
    const std::uint32_t now = std::clamp(measured_ticks_ + lead_.ticks, first, last);
    temperature_.over_drive(lead_, now - first, drive);
    return axes_[axis].visit(which, [&](const auto& p) { return p.predict_heading(lead, drive); });
  }

  /// Never still while the vehicle turns without pulses: nothing is learnt then.
  [[nodiscard]] constexpr core::Motion motion() const {
    const core::Motion motion = standstill_.motion(newest_sample_);
    return motion == core::Motion::still && odometer_.turns() ? core::Motion::settling : motion;
  }
  /// The filter's tick of the newest sample, counted from the first one.
  [[nodiscard]] constexpr std::uint32_t tick() const { return average_.tick(); }
  /// Ticks up to and with the newest one that has been learnt from.
  [[nodiscard]] constexpr std::uint32_t measured_ticks() const { return measured_ticks_; }

  [[nodiscard]] constexpr State state() const;
  constexpr void restore(const State& state);

  /// What is worth keeping while the power is off: the Kalman predictor of an axis, as of the
  /// newest measurement. The other predictors begin anew at the next stop.
  [[nodiscard]] constexpr const Filter& filter(std::size_t axis) const {
    return axes_[axis].kalman.state();
  }
  /// Whether that is worth keeping: each axis has a measurement, and others have borne it out.
  [[nodiscard]] constexpr bool has_learnt() const {
    return std::all_of(axes_.begin(), axes_.end(),
                       [](const Axis& axis) { return axis.kalman.state().is_confirmed(); });
  }
  [[nodiscard]] static constexpr bool has_learnt(const State& state) {
    return std::all_of(state.axes.begin(), state.axes.end(),
                       [](const AxisState& axis) { return axis.kalman.is_confirmed(); });
  }
  /// The temperature that the filters stand at, if they follow it: that of the newest measurement.
  [[nodiscard]] constexpr TickTemperature measured_temperature() const {
    return temperature_.measured();
  }
  [[nodiscard]] static constexpr TickTemperature measured_temperature(const State& state) {
    return core::TemperatureTrack<K>::measured(state.temperature);
  }
  /// Ticks from the newest measurement to the end of the one being filled.
  [[nodiscard]] constexpr std::uint32_t ticks_since_measured() const {
    return average_.tick() + 1 - measured_ticks_;
  }
  [[nodiscard]] static constexpr std::uint32_t ticks_since_measured(const State& state) {
    return state.average.tick + 1 - state.measured_ticks;
  }
  /// Goes on with what another run learnt: ages it by the ticks since its newest measurement, lets
  /// warm-up and ramp begin anew, and adds what the bias changes by while the power is off. Before
  /// the first sample.
  /// @param filter_of gives the filter of an axis: one at a time, to spare the stack
  template <class FilterOf>
  void resume(FilterOf filter_of, TickTemperature temperature, std::uint32_t ticks) {
    ZERORATE_ASSERT(!has_sample_);
    temperature_.resume(temperature);
    resume_filters(filter_of, ticks);
    predict_tick();
  }

 private:
  struct Axis {
    core::KalmanPredictor<R, C, K> kalman;
    core::MovingAverage<R, C, Capacity.average_levels> moving_average;
    core::CalibrationMean<R, C> calibration_mean;
    core::InnovationMonitor monitor;

    constexpr Axis(const core::Modes<R, C>& modes,
                   const core::KalmanCoefficients<R, C, K>& coefficients)
        : kalman(coefficients), moving_average(modes), calibration_mean(modes) {}

    template <class Action>
    constexpr auto visit(Predictor which, Action action) const {
      switch (which) {
        case Predictor::moving_average:
          return action(moving_average);
        case Predictor::calibration_mean:
          return action(calibration_mean);
        case Predictor::kalman:
          break;
      }
      return action(kalman);
    }

    constexpr void begin_stop() {
      kalman.begin_stop();
      moving_average.begin_stop();
      calibration_mean.begin_stop();
    }
    constexpr void observe(const Span& since_last, float rate_rad_s, float white_variance) {
      monitor.observe(kalman.step(since_last, rate_rad_s, white_variance));
      (void)moving_average.step(since_last, rate_rad_s, white_variance);
      (void)calibration_mean.step(since_last, rate_rad_s, white_variance);
    }
  };

  /// False for what is not finite, and beyond what anything can measure that turns: its square
  /// would not be finite either. In bits, which are in the order of the magnitudes, for processors
  /// without floating point.
  [[nodiscard]] static constexpr bool is_possible(core::AngularRate rate) {
    constexpr float kLargest_rad_s = 1e6F;
    return (std::bit_cast<std::uint32_t>(rate.in(core::rad_per_s)) & 0x7FFF'FFFFU) <=
           std::bit_cast<std::uint32_t>(kLargest_rad_s);
  }
  [[nodiscard]] constexpr bool is_refused(const drivers::GyroSample& sample, Health& health) const;
  constexpr void take_in(const drivers::GyroSample& sample);
  constexpr void close_tick();
  template <class FilterOf>
  [[gnu::noinline]] void resume_filters(FilterOf filter_of, std::uint32_t ticks);
  /// Not inlined: it is called at two places, and a board counts bytes.
  [[gnu::noinline]] bool learn_until(core::Instant certain);
  constexpr void learn(const HeldTick& mean);
  constexpr void end_stop(core::Instant pulse);
  constexpr void update_lead();
  constexpr void predict_tick();
  constexpr void describe(RateMessage& message, const std::array<core::AngularRate, kAxes>& rate);
  [[nodiscard]] constexpr AxisRate corrected(std::size_t axis, core::AngularRate measured) const;

  const Params& params_;
  core::Transition<R, C> one_tick_;
  core::Standstill standstill_;
  core::OdometerCheck odometer_;
  core::TickAverage<kAxes> average_;
  HoldBack held_;
  [[no_unique_address]] core::TemperatureTrack<K> temperature_;
  [[no_unique_address]] Screening screening_;
  core::KalmanCoefficients<R, C, K> coefficients_;
  std::array<Axis, kAxes> axes_;
  std::array<core::Prediction, kAxes> predicted_{};  ///< by the published predictor, for this tick
  Span lead_{};
  std::uint32_t measured_ticks_ = 0;
  core::Instant newest_sample_;
  bool has_sample_ = false;
  bool stop_open_ = false;
  bool odometer_fault_ = false;
  bool calibrated_ = false;
};

template <std::size_t R, std::size_t C, std::size_t K, NodeCapacity Capacity>
constexpr core::Result<void, ParamsError> GyroNode<R, C, K, Capacity>::check(const Params& params) {
  using core::Unexpected;
  constexpr core::Duration kZero;
  if (params.modes.tick <= kZero || params.sample_period <= kZero) {
    return Unexpected{ParamsError::tick_not_positive};
  }
  if (params.modes.tick < params.sample_period) {
    return Unexpected{ParamsError::tick_shorter_than_sample};
  }
  if (!core::is_measurement(0.0F, params.white_variance_rad2_s2)) {
    return Unexpected{ParamsError::white_variance_not_positive};
  }
  if (!Capacity.screens_samples && params.samples.is_on()) {
    return Unexpected{ParamsError::no_room_for_samples};
  }
  if (params.standstill.settle < kZero || params.standstill.hold_back < kZero ||
      params.standstill.slowest < kZero) {
    return Unexpected{ParamsError::negative_time};
  }
  // The line holds every tick that has not ended a hold-back ago: those and the one being closed.
  if (params.standstill.hold_back / params.modes.tick + 2 > std::int64_t{kHeldTicks}) {
    return Unexpected{ParamsError::hold_back_too_long};
  }
  return {};
}

template <std::size_t R, std::size_t C, std::size_t K, NodeCapacity Capacity>
constexpr RateMessage GyroNode<R, C, K, Capacity>::step(const drivers::GyroSample& sample) {
  RateMessage message{.time = sample.time};
  const bool refused = is_refused(sample, message.health);
  if (!refused) take_in(sample);

  message.motion = motion();
  message.health.saturated = sample.saturated_axes != 0 || screening_.is_saturated(sample.rate);
  describe(message, refused ? std::array<core::AngularRate, kAxes>{} : sample.rate);
  return message;
}

template <std::size_t R, std::size_t C, std::size_t K, NodeCapacity Capacity>
constexpr RateMessage GyroNode<R, C, K, Capacity>::step_without_sample(core::Instant now) {
  RateMessage message{.time = now};
  message.health.sensor_fault = true;
  describe(message, {});
  return message;
}

/// Fills in what does not depend on whether there was a sample.
template <std::size_t R, std::size_t C, std::size_t K, NodeCapacity Capacity>
constexpr void GyroNode<R, C, K, Capacity>::describe(
    RateMessage& message, const std::array<core::AngularRate, kAxes>& rate) {
  message.health.calibrated = calibrated_;
  message.health.odometer_fault = odometer_fault_;
  odometer_fault_ = false;
  message.health.odometer_disagreement = odometer_.disagrees();
  message.health.measurement_rejected = screening_.is_disturbed();
  message.health.temperature_missing = temperature_.is_missed(message.time);
  for (std::size_t i = 0; i < kAxes; ++i) {
    message.health.model_inconsistent |= !axes_[i].monitor.is_consistent();
    message.health.measurement_rejected |= axes_[i].kalman.state().rejected > 0;
    message.axes[i] = corrected(i, rate[i]);
  }
}

template <std::size_t R, std::size_t C, std::size_t K, NodeCapacity Capacity>
constexpr bool GyroNode<R, C, K, Capacity>::is_refused(const drivers::GyroSample& sample,
                                                       Health& health) const {
  health.sample_refused = !std::all_of(sample.rate.begin(), sample.rate.end(), is_possible);
  health.time_refused =
      (has_sample_ && sample.time <= newest_sample_) || !average_.can_take(sample.time);
  return health.sample_refused || health.time_refused;
}

template <std::size_t R, std::size_t C, std::size_t K, NodeCapacity Capacity>
constexpr void GyroNode<R, C, K, Capacity>::take_in(const drivers::GyroSample& sample) {
  newest_sample_ = sample.time;
  standstill_.start(sample.time);
  const bool new_tick = !has_sample_ || average_.is_over_at(sample.time);
  has_sample_ = true;
  if (new_tick && !average_.is_empty()) close_tick();
  if (new_tick) {
    average_.enter(sample.time);
    screening_.begin_tick(predicted_, params_.white_variance_rad2_s2,
                          params_.measurement_floor_variance_rad2_s2);
  }
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  temperature_.take(sample.time, new_tick,
                    sample.has_temperature ? sample.temperature.degc() : kNone);
  const auto rate_rad_s = [&sample] {
    return std::array<float, kAxes>{sample.rate[0].in(core::rad_per_s),
                                    sample.rate[1].in(core::rad_per_s),
                                    sample.rate[2].in(core::rad_per_s)};
  };
  if (!standstill_.is_settled(sample.time)) {
    if (new_tick) odometer_.on_driving_tick(rate_rad_s());
  } else if (sample.saturated_axes == 0 && screening_.take(rate_rad_s())) {
    average_.add(sample.time, rate_rad_s());
  }
  // Not before the next tick is judged, which with a hold-back of one tick is by a sample later.
  const bool learnt = held_.size() > 0 && learn_until(standstill_.release_until(sample.time) -
                                                      params_.sample_period / 2);
  if (new_tick || learnt) predict_tick();
}

/// Holds the tick back, unless a rotation without pulses speaks against it and all that is held.
template <std::size_t R, std::size_t C, std::size_t K, NodeCapacity Capacity>
constexpr void GyroNode<R, C, K, Capacity>::close_tick() {
  const HeldTick closed{average_.close(), temperature_.tick(), screening_.squares()};
  const std::array<float, kAxes> predicted_rad_s{predicted_[0].bias_rad_s, predicted_[1].bias_rad_s,
                                                 predicted_[2].bias_rad_s};
  odometer_.on_standing_tick(closed.rate_rad_s, closed.samples,
                             predicted_[0].is_available() ? &predicted_rad_s : nullptr);
  if (odometer_.turns()) {
    held_.clear();
  } else {
    held_.push(closed);
  }
}

/// Learns from the ticks that are held back and end no later than this; says whether there were
/// any.
template <std::size_t R, std::size_t C, std::size_t K, NodeCapacity Capacity>
bool GyroNode<R, C, K, Capacity>::learn_until(core::Instant certain) {
  const std::size_t held = held_.size();
  held_.release_until(certain, [this](const HeldTick& mean) { learn(mean); });
  return held_.size() < held;
}

template <std::size_t R, std::size_t C, std::size_t K, NodeCapacity Capacity>
constexpr void GyroNode<R, C, K, Capacity>::end_stop(core::Instant pulse) {
  standstill_.pulse(pulse);
  average_.clear();
  screening_.end_stop();
  stop_open_ = false;
}

template <std::size_t R, std::size_t C, std::size_t K, NodeCapacity Capacity>
constexpr void GyroNode<R, C, K, Capacity>::learn(const HeldTick& mean) {
  const std::uint32_t ticks = mean.tick + 1 - measured_ticks_;
  Span since_last{ticks == 1 ? one_tick_ : params_.modes.over(ticks)};
  temperature_.measure(mean.temperature, since_last);
  screening_.advance(ticks);
  const auto samples = static_cast<float>(mean.samples);
  for (std::size_t i = 0; i < kAxes; ++i) {
    if (!stop_open_) axes_[i].begin_stop();
    const float white_variance = screening_.level(i) * params_.white_variance_rad2_s2 / samples +
                                 params_.measurement_floor_variance_rad2_s2;
    axes_[i].observe(since_last, mean.rate_rad_s[i], white_variance);
    screening_.observe(i, mean.squares, params_.white_variance_rad2_s2, samples);
  }
  stop_open_ = true;
  measured_ticks_ = mean.tick + 1;
}

template <std::size_t R, std::size_t C, std::size_t K, NodeCapacity Capacity>
constexpr void GyroNode<R, C, K, Capacity>::predict_tick() {
  update_lead();
  for (std::size_t i = 0; i < kAxes; ++i) predicted_[i] = predict(params_.published, i);
  calibrated_ = predicted_[0].is_available() && has_learnt();
}

template <std::size_t R, std::size_t C, std::size_t K, NodeCapacity Capacity>
constexpr void GyroNode<R, C, K, Capacity>::update_lead() {
  const std::uint32_t ticks = ticks_since_measured();
  temperature_.lead_over(ticks, lead_);
  if (ticks == lead_.ticks) return;
  // One more tick is one composition. Every 1024 the span is made afresh by doubling, so that the
  // roundings of a long drive do not add up.
  constexpr std::uint32_t kAfresh = 1024;
  core::Transition<R, C>& lead = lead_;
  lead = ticks == lead_.ticks + 1 && ticks % kAfresh != 0 ? then(lead, one_tick_)
                                                          : params_.modes.over(ticks);
}

template <std::size_t R, std::size_t C, std::size_t K, NodeCapacity Capacity>
constexpr AxisRate GyroNode<R, C, K, Capacity>::corrected(std::size_t axis,
                                                          core::AngularRate measured) const {
  const core::AngularRate bias = core::rad_per_s(predicted_[axis].bias_rad_s);
  return {.measured = measured,
          .corrected = measured - bias,
          .bias = bias,
          .sigma = core::rad_per_s(predicted_[axis].sigma_rad_s())};
}

template <std::size_t R, std::size_t C, std::size_t K, NodeCapacity Capacity>
constexpr typename GyroNode<R, C, K, Capacity>::State GyroNode<R, C, K, Capacity>::state() const {
  State state{.newest_sample = newest_sample_,
              .has_sample = has_sample_,
              .stop_open = stop_open_,
              .odometer_fault = odometer_fault_,
              .measured_ticks = measured_ticks_,
              .lead = lead_,
              .standstill = standstill_.state(),
              .odometer = odometer_.state(),
              .average = average_.state(),
              .held = held_,
              .temperature = temperature_.state(),
              .screening = screening_.state(),
              .axes = {}};
  for (std::size_t i = 0; i < kAxes; ++i) {
    state.axes[i] = {.kalman = axes_[i].kalman.state(),
                     .moving_average = axes_[i].moving_average.state(),
                     .calibration_mean = axes_[i].calibration_mean.state(),
                     .monitor = axes_[i].monitor.state()};
  }
  return state;
}

template <std::size_t R, std::size_t C, std::size_t K, NodeCapacity Capacity>
constexpr void GyroNode<R, C, K, Capacity>::restore(const State& state) {
  newest_sample_ = state.newest_sample;
  has_sample_ = state.has_sample;
  stop_open_ = state.stop_open;
  odometer_fault_ = state.odometer_fault;
  measured_ticks_ = state.measured_ticks;
  lead_ = state.lead;
  standstill_.restore(state.standstill);
  odometer_.restore(state.odometer);
  average_.restore(state.average);
  held_ = state.held;
  temperature_.restore(state.temperature);
  screening_.restore(state.screening);
  for (std::size_t i = 0; i < kAxes; ++i) {
    axes_[i].kalman.restore(state.axes[i].kalman);
    axes_[i].moving_average.restore(state.axes[i].moving_average);
    axes_[i].calibration_mean.restore(state.axes[i].calibration_mean);
    axes_[i].monitor.restore(state.axes[i].monitor);
  }
  if (has_sample_) predict_tick();
}

/// Not inlined: what stands on the stack here is gone when the bias is predicted.
template <std::size_t R, std::size_t C, std::size_t K, NodeCapacity Capacity>
template <class FilterOf>
void GyroNode<R, C, K, Capacity>::resume_filters(FilterOf filter_of, std::uint32_t ticks) {
  const Span off{params_.modes.over(ticks)};
  for (std::size_t i = 0; i < kAxes; ++i) {
    axes_[i].kalman.restore(filter_of(i));
    axes_[i].kalman.advance(off);
    axes_[i].kalman.restart_transients();
    axes_[i].kalman.inflate_variance(params_.turn_on_variance_rad2_s2);
  }
}

}  // namespace zerorate::app
