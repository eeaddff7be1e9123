/// @file
/// The node: samples and odometer pulses in, bias-corrected rate with its interval out.
///
/// The microcontroller image, the Linux daemon and a replay on a PC call GyroNode::step. What
/// follows a closed tick is TickNode, which the likelihood of a recording and the gain of a model
/// run too: there is no second copy of a formula (docs/adr/0002).
///
/// The life of a tick:
///
///     GyroSample --> TickNode::take --> StopLearning --> TickNode::learn --> RateMessage
///      (a driver)     wild samples are   settle,          one step or more     rate less bias,
///                     left out           average,         a sample             sigma, Health,
///                                        hold back                             Motion
///                                           ^
///     odometer pulse -----------------------+
///     temperature, acceleration ---> TickNode: inputs of the tick, held beside its mean
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/base/result.hpp"
#include "core/samples/gyro_sample.hpp"
#include "core/standstill/stop_learning.hpp"
#include "firmware/app/node_params.hpp"
#include "firmware/app/rate_message.hpp"
#include "firmware/app/sample_screening.hpp"
#include "firmware/app/tick_forecast.hpp"
#include "firmware/app/tick_node.hpp"
#include "firmware/app/turn_track.hpp"

namespace zerorate::app {

/// One sensor. Chip-free and board-free; no heap; one thread (the caller's).
///
/// What a tick costs is spread over the samples of the next one, so that no call is long: a rate is
/// published with the newest prediction that is complete (docs/adr/0020).
/// Cost per sample: a few additions and its share of TickCosts::of_tick().
template <ModelShape Shape, NodeCapacity Capacity = NodeCapacity{}>
class GyroNode {
 public:
  static constexpr ModelShape kShape = Shape;
  static constexpr std::size_t kAxes = Capacity.axes;
  static constexpr bool kScreensSamples = Capacity.screens_samples;
  using Params = NodeParams<Shape>;
  using Ticks = TickNode<Shape, Capacity>;
  using Predictors = typename Ticks::Predictors;
  using Transition = typename Ticks::Transition;
  using InputTrack = typename Ticks::InputTrack;
  using TickInputs = typename Ticks::TickInputs;
  using Screening = typename Ticks::Screening;
  using Turn = TurnTrack<Ticks>;
  using Learning =
      core::StopLearning<typename Ticks::Tick, kAxes, Capacity.held_ticks, Shape.has_accelerometer>;

  /// Everything the node remembers; restored into a node with the same parameters it continues
  /// bit for bit.
  struct State {
    bool odometer_fault = false;  ///< not yet published
    std::int32_t credit = 0;      ///< cost units that may be spent; negative: spent in advance
    typename Turn::State turn;
    typename Learning::State learning;
    typename Ticks::State ticks;

    constexpr bool operator==(const State&) const = default;
    [[nodiscard]] constexpr std::uint32_t ticks_since_measured() const {
      return ticks.ticks_since_measured();
    }
  };
  static_assert(std::is_trivially_copyable_v<State>);

  [[nodiscard]] static constexpr core::Result<void, ParamsError> check(const Params& params) {
    return app::check(params, Capacity);
  }

  /// @param params must pass check() and outlive the node
  constexpr explicit GyroNode(const Params& params)
      : params_(params),
        pace_(pace_of(params)),
        learning_(params.standstill, params.odometer, params.model.modes.tick,
                  params.model.sample_period, params.model.white_variance_rad2_s2),
        ticks_(params),
        turn_(params) {
    ZERORATE_ASSERT(check(params).has_value());
  }

  /// An odometer pulse. Before step() with a sample that is not older.
  constexpr void pulse(core::Instant at) {
    learning_.pulse(at);
    ticks_.end_stop();
  }

  /// Specific force along the axes of the chip, at the newest sample or after it. A sample that has
  /// its own needs no call.
  constexpr void take_acceleration(core::Instant at,
                                   const std::array<core::Acceleration, 3>& acceleration) {
    ticks_.inputs().take_acceleration(at, acceleration);
  }

  /// The odometer input failed or dropped edges: the vehicle was moving, and it is unknown since
  /// when. No tick that is held back is certain any more.
  constexpr void report_odometer_fault(core::Instant now) {
    odometer_fault_ = true;
    learning_.report_odometer_fault(now);
    ticks_.end_stop();
  }

  /// The newest samples were none of the vehicle's rate: the stop is over, and no tick that is held
  /// back is learnt.
  constexpr void discard_stop(core::Instant now) {
    learning_.interrupt(now);
    ticks_.end_stop();
  }

  /// Time passed that the stamps of the samples do not contain, or the gyro was without power. The
  /// stop is over; the bias is aged by that time, and by what the power changes it by. A long call
  /// with many hypotheses.
  /// @param slept time that the clock does not count; zero where it went on
  constexpr void report_pause(core::Instant now, core::Duration slept, bool has_lost_power) {
    constexpr std::int64_t kMostTicks = std::int64_t{1} << 30U;
    discard_stop(now);
    turn_.lose();
    finish_learning();
    const auto ticks = std::clamp(slept / params_.model.modes.tick, std::int64_t{0}, kMostTicks);
    ticks_.pass_pause(static_cast<std::uint32_t>(ticks), has_lost_power);
  }

  /// Takes one sample. Samples must come in the order of their time stamps; one that is not newer
  /// than the one before, or not finite, is refused with a flag and changes nothing.
  constexpr RateMessage step(const core::GyroSample& sample) {
    RateMessage message{.time = sample.time};
    const bool refused = refuse(sample, message.health);
    const core::Duration since_last = since_newest_sample(sample.time);
    const Rate rate = refused ? kNoRate : params_.model.corrected(sample.rate);
    if (!refused) take_in(sample, rate);
    message.motion = motion();
    if (sample.has_temperature) message.temperature = sample.temperature;
    message.health.saturated =
        sample.saturated_axes != 0 || ticks_.screening().is_saturated(rates_of(sample));
    describe(message, refused ? kNoRate : sample.rate, rate);
    if (!refused) turn_.add(message, since_last, sample.saturated_axes, is_learning(), ticks_);
    turn_.describe({}, message);
    return message;
  }

  /// Message while the gyro gives no samples: without a rate, with the bias and its interval as of
  /// the newest sample, and without a claim that the vehicle stands.
  constexpr RateMessage step_without_sample(core::Instant now) {
    RateMessage message{.time = now};
    message.health.sensor_fault = true;
    describe(message, {}, {});
    turn_.describe(since_newest_sample(now), message);
    return message;
  }

  /// A reference of the heading or of a turn about the vertical, at or before the newest sample:
  /// teaches the scale factor, and the bias while the vehicle moves.
  /// @param reference HeadingReference or TurnReference, finite and with a positive deviation
  template <class Reference>
  constexpr core::ReferenceVerdict take_reference(const Reference& reference) {
    return turn_.take(reference, newest_sample(), ticks_);
  }
  /// Whether the vertical is given, or was measured.
  [[nodiscard]] constexpr bool has_vertical() const { return turn_.vertical().is_known(); }
  /// Heading at the newest sample. Of nodes that take references, as the filter of them.
  [[nodiscard]] constexpr Heading heading() const { return turn_.heading(); }
  [[nodiscard]] constexpr const core::HeadingFilter& heading_filter() const {
    return turn_.references().filter();
  }

  /// Learns at once from the ticks that are certain, before a record is saved. A long call with
  /// many hypotheses.
  constexpr void finish_learning() {
    while (is_learning()) one_step();
  }

  /// Bias that a predictor expects at the newest sample, alone and with its variance.
  [[nodiscard]] constexpr core::AngularRate bias(Predictor which, std::size_t axis) const {
    return core::rad_per_s(forecast().bias_rad_s(which, axis));
  }
  [[nodiscard]] constexpr core::Prediction predict(Predictor which, std::size_t axis) const {
    return with_constants(forecast().predict(which, axis), axis);
  }
  /// Predicted integral of the bias from `from` to `to` (both at or after the newest measurement),
  /// in whole ticks.
  [[nodiscard]] constexpr core::HeadingPrediction predict_heading(Predictor which, std::size_t axis,
                                                                  core::Instant from,
                                                                  core::Instant to) const {
    const std::uint32_t first = std::max(learning_.tick_of(from), ticks_.measured_ticks());
    const std::uint32_t last = std::max(learning_.tick_of(to), first);
    core::HeadingPrediction heading = forecast().predict_heading(which, axis, first, last);
    const float length_s = (params_.model.modes.tick * std::int64_t{last - first}).in_seconds();
    heading.variance_rad2 += forecast().constant_variance_rad2_s2(axis) * length_s * length_s;
    return heading;
  }

  [[nodiscard]] constexpr core::Motion motion() const { return learning_.motion(); }
  [[nodiscard]] constexpr bool has_sample() const { return learning_.has_sample(); }
  /// Time of the newest sample that was taken; the clock's zero before there is one.
  [[nodiscard]] constexpr core::Instant newest_sample() const { return learning_.newest_sample(); }
  /// Whether step() takes a sample.
  [[nodiscard]] constexpr bool can_take(const core::GyroSample& sample) const {
    Health health;
    return !refuse(sample, health);
  }
  /// The filter's tick of the newest sample, counted from the first one.
  [[nodiscard]] constexpr std::uint32_t tick() const { return learning_.tick(); }
  /// Ticks up to and with the newest one that has been learnt from.
  [[nodiscard]] constexpr std::uint32_t measured_ticks() const { return ticks_.measured_ticks(); }
  /// Whether a tick that is certain has not been learnt from, or not completely.
  [[nodiscard]] constexpr bool is_learning() const {
    return ticks_.is_learning() || learning_.confirmed() > 0;
  }

  [[nodiscard]] constexpr State state() const {
    return {.odometer_fault = odometer_fault_,
            .credit = credit_,
            .turn = turn_.state(),
            .learning = learning_.state(),
            .ticks = ticks_.state()};
  }
  /// Goes on from a state of a node with the same parameters, bit for bit.
  constexpr void restore(const State& state) {
    odometer_fault_ = state.odometer_fault;
    credit_ = state.credit;
    turn_.restore(state.turn);
    if constexpr (Ticks::kMeasuresVertical) ticks_.set_earth(turn_.earth());
    ticks_.restore(state.ticks);
    learning_.restore(state.learning, ticks_.white());
  }

  /// Variance of the white noise of a sample: as this sensor has shown it, or by the model.
  [[nodiscard]] constexpr float white_variance_rad2_s2(std::size_t axis) const {
    return ticks_.white_variance_rad2_s2(axis);
  }

  [[nodiscard]] constexpr const Params& params() const { return params_; }
  [[nodiscard]] constexpr const Ticks& ticks() const { return ticks_; }
  [[nodiscard]] constexpr const Predictors& predictors() const { return ticks_.predictors(); }
  /// Goes on, before the first sample, with what another run learnt; see TickNode::resume().
  template <class... Learnt>
  void resume(const Learnt&... learnt) {
    ZERORATE_ASSERT(!learning_.has_sample());
    ticks_.resume(learnt...);
  }
  /// Likewise with what references taught. Of nodes that take them.
  constexpr void resume_motion(const core::LearntMotion& learnt, float pause_s) {
    turn_.resume(learnt, pause_s);
  }

 private:
  using Rate = std::array<core::AngularRate, 3>;
  using Rates = std::array<float, kAxes>;
  static constexpr Rate kNoRate{};
  static constexpr std::int32_t kShortCall = 8;  ///< cost units of a call that is short

  [[nodiscard]] static constexpr std::int32_t pace_of(const Params& params) {
    const std::int64_t samples = params.model.modes.tick / params.model.sample_period;
    return Ticks::Costs::pace(
        static_cast<std::uint32_t>(std::clamp(samples, std::int64_t{1}, std::int64_t{0xFFFF})),
        params.published != Predictor::kalman);
  }
  [[nodiscard]] constexpr TickForecast<Ticks> forecast() const {
    return TickForecast<Ticks>{ticks_};
  }
  [[nodiscard]] static constexpr std::array<core::AngularRate, kAxes> rates_of(
      const core::GyroSample& sample) {
    std::array<core::AngularRate, kAxes> rates;
    std::copy_n(sample.rate.begin(), kAxes, rates.begin());
    return rates;
  }

  [[nodiscard]] constexpr core::Prediction with_constants(core::Prediction bias,
                                                          std::size_t axis) const {
    bias.variance_rad2_s2 += forecast().constant_variance_rad2_s2(axis);
    return bias;
  }
  [[nodiscard]] constexpr bool refuse(const core::GyroSample& sample, Health& health) const {
    health.sample_refused = !std::all_of(sample.rate.begin(), sample.rate.end(), is_possible);
    health.time_refused = !learning_.can_take(sample.time);
    return health.sample_refused || health.time_refused;
  }
  constexpr void take_in(const core::GyroSample& sample, const Rate& rate) {
    const bool begins_tick = learning_.begin_sample(sample.time);
    if (begins_tick) {
      catch_up();
      turn_to_tick(sample.time);
    }
    ticks_.inputs().take(sample, begins_tick);
    Rates rate_rad_s{};
    for (std::size_t i = 0; i < kAxes; ++i) {
      rate_rad_s[i] = rate[i].in(core::rad_per_s)-ticks_.earth().vertical_rad_s[i];
    }
    ticks_.white().rounding().take(rate_rad_s);
    learning_.add(sample.time, begins_tick, rate_rad_s,
                  [&] { return sample.saturated_axes == 0 && ticks_.take(rate_rad_s); });
    learning_.confirm_at(sample.time);
    work();
  }
  /// Does what lost samples have left undone; then this call is as long as their shares.
  /// Not inlined: a board counts its stack.
  [[gnu::noinline]] constexpr void catch_up() {
    while (learning_.is_behind()) one_step();
  }
  /// Closes the tick that is over, and begins the next one.
  constexpr void turn_to_tick(core::Instant at) {
    const auto& predicted = ticks_.predicted();
    Rates predicted_rad_s{};
    for (std::size_t i = 0; i < kAxes; ++i) predicted_rad_s[i] = predicted[i].bias_rad_s;
    learning_.close_tick(
        ticks_.inputs().tick_force(), predicted[0].is_available() ? &predicted_rad_s : nullptr,
        predicted[0].variance_rad2_s2, ticks_.white(),
        [&](const core::TickMean<kAxes>& mean) { return ticks_.measurement(mean); });
    learning_.enter_tick(at);
    ticks_.begin_tick(learning_.tick());
    ticks_.begin_samples();
    turn_.close_tick(ticks_);
    if constexpr (Ticks::kMeasuresVertical) ticks_.set_earth(turn_.earth());
  }

  /// Does the share of a sample, more where several ticks wait and the call stays short. A step
  /// that costs more than is left of the share is paid by the samples that follow, and waits for
  /// them where the call would be longer than its longest step.
  constexpr void work() {
    if (pace_ == Ticks::Costs::kAtOnce) {
      while (learning_.confirmed() > 0) {
        (void)ticks_.learn_at_once(learning_.take_confirmed(), learning_.sway_variance_rad2_s2());
      }
      return ticks_.finish();
    }
    const auto waiting = static_cast<std::int32_t>(std::max(learning_.confirmed(), std::size_t{1}));
    const std::int32_t share = std::max(pace_, std::min(pace_ * waiting, kShortCall));
    credit_ += share;
    std::int32_t spent = 0;
    while (credit_ > 0 && begin_step()) {
      const auto cost = static_cast<std::int32_t>(ticks_.next_cost());
      if (spent > 0 && spent + cost > Ticks::Costs::longest_call(share)) return;
      ticks_.step();
      spent += cost;
      credit_ -= cost;
    }
    credit_ = std::min(credit_, std::int32_t{0});
  }
  /// A tick is predicted before the next measurement is learnt.
  /// @return whether there is a step to do
  constexpr bool begin_step() {
    if (ticks_.is_busy()) return true;
    if (learning_.confirmed() == 0) return false;
    ticks_.learn(learning_.take_confirmed(), learning_.sway_variance_rad2_s2());
    return true;
  }
  constexpr void one_step() {
    if (begin_step()) ticks_.step();
  }

  /// Fills in what does not depend on whether there was a sample.
  /// @param rate measured, without the known errors of the scale factors
  constexpr void describe(RateMessage& message, const Rate& measured, const Rate& rate) {
    const auto& predicted = ticks_.predicted();
    const auto& predictors = ticks_.predictors();
    message.health.calibrated = predicted[0].is_available() && predictors.has_learnt();
    message.health.odometer_fault = odometer_fault_;
    odometer_fault_ = false;
    message.health.odometer_disagreement = learning_.odometer_disagrees();
    message.health.odometer_dead_band = learning_.has_dead_band();
    message.calm_percent = learning_.calm().share().percent();
    message.health.measurement_rejected =
        ticks_.screening().is_disturbed() || predictors.filter().rejected > 0;
    message.health.temperature_missing = ticks_.inputs().misses_temperature(message.time);
    message.health.acceleration_missing = ticks_.inputs().misses_acceleration(message.time);
    for (std::size_t i = 0; i < kAxes; ++i) {
      message.health.model_inconsistent |=
          !predictors.is_consistent(i) || params_.is_beyond_zero_rate(predicted[i].bias_rad_s);
      const core::AngularRate bias = core::rad_per_s(predicted[i].bias_rad_s);
      message.axes[i] = {
          .measured = measured[i],
          .corrected = rate[i] - core::rad_per_s(ticks_.earth().vertical_rad_s[i]) - bias,
          .bias = bias,
          .sigma = core::rad_per_s(with_constants(predicted[i], i).sigma_rad_s())};
    }
    turn_.correct(message);
  }

  [[nodiscard]] constexpr core::Duration since_newest_sample(core::Instant now) const {
    return has_sample() ? now - newest_sample() : core::Duration{};
  }

  const Params& params_;
  std::int32_t pace_;  ///< cost units of the work of a sample
  Learning learning_;
  Ticks ticks_;
  Turn turn_;
  std::int32_t credit_ = 0;  ///< cost units that may be spent; negative: spent in advance
  bool odometer_fault_ = false;
};

}  // namespace zerorate::app
