/// @file
/// The node: samples and odometer pulses in, bias-corrected rate with its interval out.
///
/// This is the one step function of the project. The MCU image, the Linux daemon, a replay on a PC
/// and the likelihood that identifies a model all call GyroNode::step.
///
/// The life of a tick:
///
///     GyroSample --> SampleScreening --> StopLearning --> AxisPredictors --> RateMessage
///      (a driver)     wild samples are    settle,          learn from the     rate less bias,
///                     left out            average,         mean, predict      sigma, Health,
///                                         hold back        the tick           Motion
///                                            ^                being filled
///     odometer pulse -----------------------+
///     temperature ---> TemperatureTrack: weights of the tick, held beside its mean
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "core/base/result.hpp"
#include "core/samples/tick_average.hpp"
#include "core/standstill/stop_learning.hpp"
#include "core/temperature/temperature_track.hpp"
#include "drivers/common/gyro_source.hpp"
#include "firmware/app/axis_predictors.hpp"
#include "firmware/app/node_params.hpp"
#include "firmware/app/rate_message.hpp"
#include "firmware/app/sample_screening.hpp"

namespace zerorate::app {

/// One sensor with three axes. Chip-free and board-free; no heap; one thread (the caller's).
/// Cost per sample: a few additions; per tick: see the predictors.
template <ModelShape Shape, NodeCapacity Capacity = NodeCapacity{}>
class GyroNode {
 public:
  static constexpr std::size_t kAxes = 3;
  static constexpr bool kScreensSamples = Capacity.screens_samples;
  using Params = NodeParams<Shape>;
  using Predictors = AxisPredictors<Shape, Capacity>;
  using Transition = core::FilterTransition<Shape>;
  using TemperatureTrack = core::TemperatureTrack<Shape.temperature_weights>;
  using TickTemperature = core::TickTemperature<Shape.temperature_weights>;
  using Screening = SampleScreening<kAxes, Capacity.screens_samples>;
  /// A measurement that waits until it is certain that the vehicle stood.
  struct HeldTick : core::TickMean<kAxes> {
    [[no_unique_address]] TickTemperature temperature;
    [[no_unique_address]] typename Screening::Squares squares;

    constexpr bool operator==(const HeldTick&) const = default;
  };
  using Learning = core::StopLearning<HeldTick, Capacity.held_ticks>;

  /// Everything the node remembers; restored into a node with the same parameters it continues
  /// bit for bit.
  struct State {
    bool odometer_fault = false;       ///< not yet published
    std::uint32_t measured_ticks = 0;  ///< ticks up to and with the newest measurement
    Transition lead;                   ///< from there to the tick being filled
    typename Learning::State learning;
    [[no_unique_address]] typename TemperatureTrack::State temperature;
    [[no_unique_address]] typename Screening::State screening;
    typename Predictors::State predictors;

    constexpr bool operator==(const State&) const = default;
    [[nodiscard]] constexpr std::uint32_t ticks_since_measured() const {
      return learning.average.tick + 1 - measured_ticks;
    }
  };
  static_assert(std::is_trivially_copyable_v<State>);

  [[nodiscard]] static constexpr core::Result<void, ParamsError> check(const Params& params) {
    return app::check(params, Capacity);
  }

  /// @param params must pass check() and outlive the node
  constexpr explicit GyroNode(const Params& params)
      : params_(params),
        one_tick_(params.modes.one_tick()),
        learning_(params.standstill, params.odometer, params.modes.tick, params.sample_period,
                  params.white_variance_rad2_s2),
        temperature_(params.temperature),
        screening_(params.samples),
        predictors_(params) {
    ZERORATE_ASSERT(check(params).has_value());
  }

  /// An odometer pulse. Before step() with a sample that is not older.
  constexpr void pulse(core::Instant at) {
    if (learning_.pulse(at, learner())) predict_tick();
    screening_.end_stop();
  }

  /// The odometer input failed or dropped edges; that it was moving is known, but not since when:
  /// no tick that is held back is certain any more.
  constexpr void report_odometer_fault(core::Instant now) {
    odometer_fault_ = true;
    learning_.report_odometer_fault(now);
    screening_.end_stop();
  }

  /// Time passed that the clock of the samples does not count, or the gyro was without power. The
  /// stop is over; the bias is aged by that time, and by what the power changes it by.
  /// @param slept  time that the clock does not count; zero where it went on
  constexpr void report_pause(core::Instant now, core::Duration slept, bool has_lost_power) {
    constexpr std::int64_t kMostTicks = std::int64_t{1} << 30U;
    learning_.interrupt(now);
    screening_.end_stop();
    const std::int64_t ticks = std::clamp(slept / params_.modes.tick, std::int64_t{0}, kMostTicks);
    predictors_.report_pause(params_, static_cast<std::uint32_t>(ticks), has_lost_power);
    if (learning_.has_sample()) predict_tick();
  }

  /// Takes one sample. Samples must come in the order of their time stamps; one that is not newer
  /// than the one before, or not finite, is refused with a flag and changes nothing.
  constexpr RateMessage step(const drivers::GyroSample& sample) {
    RateMessage message{.time = sample.time};
    const bool refused = is_refused(sample, message.health);
    if (!refused) take_in(sample);

    message.motion = motion();
    if (sample.has_temperature) message.temperature = sample.temperature;
    message.health.saturated = sample.saturated_axes != 0 || screening_.is_saturated(sample.rate);
    describe(message, refused ? Rate{} : sample.rate);
    return message;
  }

  /// Says what is known while the gyro gives no samples: a message without a rate, the bias and its
  /// interval as of the newest sample, and no claim that the vehicle stands.
  constexpr RateMessage step_without_sample(core::Instant now) {
    RateMessage message{.time = now};
    message.health.sensor_fault = true;
    describe(message, {});
    return message;
  }

  /// Bias that a predictor expects at the newest sample, alone and with its variance.
  [[nodiscard]] constexpr core::AngularRate bias(Predictor which, std::size_t axis) const {
    return core::rad_per_s(predictors_.bias_rad_s(which, axis, lead_));
  }
  [[nodiscard]] constexpr core::Prediction predict(Predictor which, std::size_t axis) const {
    return params_.with_earth(predictors_.predict(which, lead_)[axis], axis);
  }
  /// Predicted integral of the bias from `from` to `to` (both at or after the newest measurement),
  /// in whole ticks.
  [[nodiscard]] constexpr core::HeadingPrediction predict_heading(Predictor which, std::size_t axis,
                                                                  core::Instant from,
                                                                  core::Instant to) const {
    const std::uint32_t first = std::max(learning_.tick_of(from), measured_ticks_);
    const std::uint32_t last = std::max(learning_.tick_of(to), first);
    const Transition lead{params_.modes.over(first - measured_ticks_)};
    Transition drive{params_.modes.over(last - first)};
    const std::uint32_t now = std::clamp(measured_ticks_ + lead_.ticks, first, last);
    temperature_.over_drive(lead_, now - first, drive);
    core::HeadingPrediction heading = predictors_.predict_heading(which, lead, drive)[axis];
    const float length_s = (params_.modes.tick * std::int64_t{last - first}).in_seconds();
    heading.variance_rad2 += params_.earth.heading_variance_rad2_s2[axis] * length_s * length_s;
    return heading;
  }

  [[nodiscard]] constexpr core::Motion motion() const { return learning_.motion(); }
  /// The filter's tick of the newest sample, counted from the first one.
  [[nodiscard]] constexpr std::uint32_t tick() const { return learning_.tick(); }
  /// Ticks up to and with the newest one that has been learnt from.
  [[nodiscard]] constexpr std::uint32_t measured_ticks() const { return measured_ticks_; }

  [[nodiscard]] constexpr State state() const {
    return {.odometer_fault = odometer_fault_,
            .measured_ticks = measured_ticks_,
            .lead = lead_,
            .learning = learning_.state(),
            .temperature = temperature_.state(),
            .screening = screening_.state(),
            .predictors = predictors_.state()};
  }
  /// Goes on from a state of a node with the same parameters, bit for bit.
  constexpr void restore(const State& state) {
    odometer_fault_ = state.odometer_fault;
    measured_ticks_ = state.measured_ticks;
    lead_ = state.lead;
    learning_.restore(state.learning);
    temperature_.restore(state.temperature);
    screening_.restore(state.screening);
    predictors_.restore(state.predictors);
    if (learning_.has_sample()) predict_tick();
  }

  /// Variance of the white noise of a sample: as this sensor has shown it, or by the model.
  [[nodiscard]] constexpr float white_variance_rad2_s2(std::size_t axis) const {
    WhiteNoise white = white_noise_of(params_, screening_, learning_.calm(), 1.0F);
    white.floor_rad2_s2 = 0.0F;
    return predictors_.white_variance(white, axis);
  }

  [[nodiscard]] constexpr const Params& params() const { return params_; }
  /// Span from the newest measurement to the tick being filled.
  [[nodiscard]] constexpr const Transition& lead() const { return lead_; }
  [[nodiscard]] constexpr const Predictors& predictors() const { return predictors_; }
  /// The temperature that the filter stands at, if it follows it: that of the newest measurement.
  [[nodiscard]] constexpr TickTemperature measured_temperature() const {
    return temperature_.measured();
  }
  /// Ticks from the newest measurement to the end of the one being filled.
  [[nodiscard]] constexpr std::uint32_t ticks_since_measured() const {
    return learning_.tick() + 1 - measured_ticks_;
  }
  /// Goes on, before the first sample, with what another run learnt: ages it by the ticks since its
  /// newest measurement, and adds what the bias changes by while the power is off.
  /// @param learnt arguments of AxisPredictors::resume(): a filter, or biases alone
  template <class... Learnt>
  void resume(TickTemperature temperature, std::uint32_t ticks, const Learnt&... learnt) {
    ZERORATE_ASSERT(!learning_.has_sample());
    temperature_.resume(temperature);
    predictors_.resume(params_, ticks, learnt...);
    predict_tick();
  }

 private:
  using Rate = std::array<core::AngularRate, kAxes>;
  [[nodiscard]] constexpr bool is_refused(const drivers::GyroSample& sample, Health& health) const {
    health.sample_refused = !std::all_of(sample.rate.begin(), sample.rate.end(), is_possible);
    health.time_refused = !learning_.can_take(sample.time);
    return health.sample_refused || health.time_refused;
  }
  constexpr void take_in(const drivers::GyroSample& sample) {
    const bool begins_tick = learning_.begin_sample(sample.time);
    if (begins_tick) {
      const std::array<float, kAxes> predicted_rad_s{
          predicted_[0].bias_rad_s, predicted_[1].bias_rad_s, predicted_[2].bias_rad_s};
      learning_.close_tick(predicted_[0].is_available() ? &predicted_rad_s : nullptr,
                           predicted_[0].variance_rad2_s2, temperature_.tick(),
                           screening_.squares());
      learning_.enter_tick(sample.time);
      screening_.begin_tick(predicted_, params_.white_variance_rad2_s2,
                            params_.measurement_floor_variance_rad2_s2);
    }
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    temperature_.take(sample.time, begins_tick,
                      sample.has_temperature ? sample.temperature.degc() : kNone);
    std::array<float, kAxes> rate_rad_s{};
    for (std::size_t i = 0; i < kAxes; ++i) {
      rate_rad_s[i] = sample.rate[i].in(core::rad_per_s)-params_.earth.vertical_rad_s[i];
    }
    learning_.add(sample.time, begins_tick, rate_rad_s,
                  [&] { return sample.saturated_axes == 0 && screening_.take(rate_rad_s); });
    if (learning_.release_at(sample.time, learner()) || begins_tick) predict_tick();
  }

  /// Callback of StopLearning for each tick that is certain.
  [[nodiscard]] constexpr auto learner() {
    return [this](const HeldTick& mean, bool begins_stop) {
      const std::uint32_t ticks = mean.tick + 1 - measured_ticks_;
      Transition since_last{ticks == 1 ? one_tick_ : params_.modes.over(ticks)};
      temperature_.measure(mean.temperature, since_last);
      screening_.advance(ticks);
      if (begins_stop) predictors_.begin_stop();
      const auto samples = static_cast<float>(mean.samples);
      predictors_.observe(since_last, mean.rate_rad_s,
                          white_noise_of(params_, screening_, learning_.calm(), samples));
      screening_.observe(mean.squares, params_.white_variance_rad2_s2, samples);
      measured_ticks_ = mean.tick + 1;
    };
  }

  constexpr void predict_tick() {
    temperature_.lead_over(ticks_since_measured(), lead_);
    params_.modes.lead_over(ticks_since_measured(), one_tick_, lead_);
    predicted_ = predictors_.predict(params_.published, lead_);
  }

  /// Fills in what does not depend on whether there was a sample.
  constexpr void describe(RateMessage& message, const Rate& rate) {
    message.health.calibrated = predicted_[0].is_available() && predictors_.has_learnt();
    message.health.odometer_fault = odometer_fault_;
    odometer_fault_ = false;
    message.health.odometer_disagreement = learning_.odometer_disagrees();
    message.health.odometer_dead_band = learning_.has_dead_band();
    message.calm_percent = learning_.calm().percent();
    message.health.measurement_rejected =
        screening_.is_disturbed() || predictors_.filter().rejected > 0;
    message.health.temperature_missing = temperature_.is_missed(message.time);
    for (std::size_t i = 0; i < kAxes; ++i) {
      message.health.model_inconsistent |=
          !predictors_.is_consistent(i) || params_.is_beyond_zero_rate(predicted_[i].bias_rad_s);
      const core::AngularRate bias = core::rad_per_s(predicted_[i].bias_rad_s);
      message.axes[i] = {
          .measured = rate[i],
          .corrected = rate[i] - core::rad_per_s(params_.earth.vertical_rad_s[i]) - bias,
          .bias = bias,
          .sigma = core::rad_per_s(params_.with_earth(predicted_[i], i).sigma_rad_s())};
    }
  }

  const Params& params_;
  core::TransitionOf<Shape> one_tick_;
  Learning learning_;
  [[no_unique_address]] TemperatureTrack temperature_;
  [[no_unique_address]] Screening screening_;
  Predictors predictors_;
  std::array<core::Prediction, kAxes> predicted_{};  ///< by the published predictor, for this tick
  Transition lead_{};
  std::uint32_t measured_ticks_ = 0;
  bool odometer_fault_ = false;
};

}  // namespace zerorate::app
