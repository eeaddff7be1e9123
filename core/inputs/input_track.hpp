/// @file
/// The inputs of the bias between the newest measurement and now.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/inputs/accelerometer.hpp"
#include "core/inputs/thermometer.hpp"
#include "core/inputs/tick_inputs.hpp"
#include "core/samples/gyro_sample.hpp"

namespace zerorate::core {

/// Adds the inputs to the spans of a filter that measures at some ticks and predicts at others.
template <ModelShape Shape>
class InputTrack {
 public:
  static constexpr std::size_t kInputs = Shape.inputs;
  using Tick = TickInputs<Shape>;
  using Terms = InputBlock<Shape.inputs>;

  using Force = AccelerometerOf<Shape.has_accelerometer>;

  struct State {
    Thermometer::State thermometer;
    [[no_unique_address]] typename Force::State accelerometer;
    Tick tick;                         ///< being filled
    Tick measured;                     ///< inputs of the newest measurement
    std::array<float, kInputs> sum{};  ///< sum over the ticks of the changes since then
    std::uint32_t summed_ticks = 0;

    constexpr bool operator==(const State&) const = default;
  };

  /// The part of a lead that inputs need.
  struct Lead {
    std::uint32_t ticks = 0;
    InputTransition<kInputs> inputs{};
  };

  /// @param terms must outlive the track
  constexpr InputTrack(const Terms& terms, Duration tick)
      : terms_(terms),
        tick_s_(tick.in_seconds()),
        thermometer_(terms.reference_degc, terms.lag_s) {}

  [[nodiscard]] constexpr State state() const {
    return {thermometer_.state(), accelerometer_.state(), tick_, measured_, sum_, summed_ticks_};
  }
  constexpr void restore(const State& state) {
    thermometer_.restore(state.thermometer);
    accelerometer_.restore(state.accelerometer);
    tick_ = state.tick;
    measured_ = state.measured;
    sum_ = state.sum;
    summed_ticks_ = state.summed_ticks;
  }
  /// True if a restored state is valid.
  [[nodiscard]] static bool is_possible(const State& state) {
    return Thermometer::is_possible(state.thermometer) && Force::is_possible(state.accelerometer) &&
           Tick::is_possible(state.tick) && Tick::is_possible(state.measured) &&
           are_plausible(state.sum);
  }

  /// The time of every sample, and the temperature measured then: any number.
  constexpr void take(Instant at, bool begins_tick, float degc) {
    thermometer_.take(at, begins_tick, degc);
    if (!begins_tick) return;
    accelerometer_.begin_tick(at);
    begin_tick(at);
  }
  /// Every sample, with what its chip measured beside the rate.
  constexpr void take(const GyroSample& sample, bool begins_tick) {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    take(sample.time, begins_tick, sample.has_temperature ? sample.temperature.degc() : kNone);
    if (sample.has_acceleration) take_acceleration(sample.time, sample.acceleration);
  }
  /// A reading of the accelerometer, after take() of a sample that is not later.
  constexpr void take_acceleration(Instant at, const std::array<Acceleration, 3>& acceleration) {
    accelerometer_.take(at, acceleration);
  }
  /// Specific force of the tick being filled, where there is an accelerometer.
  [[nodiscard]] constexpr auto tick_force() const { return accelerometer_.tick_force(); }

  /// Inputs of the tick being filled, as they were known when it began.
  [[nodiscard]] constexpr const Tick& tick() const { return tick_; }
  /// Inputs of the tick being filled, for its measurement: the mean specific force of its own
  /// samples, because a vehicle that has just stopped leans otherwise than a moment before.
  [[nodiscard]] constexpr Tick measurement() const {
    Tick tick = tick_;
    if constexpr (Shape.has_accelerometer) {
      if (accelerometer_.state().count == 0) return tick;
      tick.unknown_s[kForce] = 0.0F;
      tick.unknown_s[kVibration] = accelerometer_.shows_vibration() ? 0.0F : tick_s_;
      fill(tick, accelerometer_.this_tick());
    }
    return tick;
  }
  [[nodiscard]] constexpr const Tick& measured() const { return measured_; }
  [[nodiscard]] static constexpr Tick measured(const State& state) { return state.measured; }

  [[nodiscard]] constexpr const Force& accelerometer() const { return accelerometer_; }
  /// Whether the model needs a temperature, or a specific force, and none is known.
  [[nodiscard]] constexpr bool misses_temperature(Instant now) const {
    return !thermometer_.is_known(now) && terms_.follows(is_thermal);
  }
  [[nodiscard]] constexpr bool misses_acceleration(Instant now) const {
    if constexpr (Shape.has_accelerometer) {
      return !accelerometer_.is_known(now) && terms_.follows(is_inertial);
    }
    return false;
  }

  /// A tick is measured; `since_last` is the span of so many ticks from the measurement before.
  constexpr void measure(const Tick& tick, std::uint32_t ticks, auto& since_last) {
    since_last.inputs = between(measured_, tick, ticks);
    measured_ = tick;
    sum_ = {};
    summed_ticks_ = 0;
  }
  /// Continues from the inputs at the last measurement of another run.
  constexpr void resume(const Tick& measured) { measured_ = measured; }

  /// Fills in a lead of so many ticks, from the newest measurement to the tick being filled. What
  /// is held back counts as what is new.
  constexpr void fill_lead(std::uint32_t ticks, auto& lead) const {
    lead.inputs = between(measured_, tick_, ticks);
    const auto more = static_cast<float>(ticks - summed_ticks_);
    for (std::size_t i = 0; i < kInputs; ++i) {
      lead.inputs.sum[i] = sum_[i] + more * lead.inputs.change[i];
    }
  }
  /// fill_lead() once a tick; the next sum goes on from this one.
  constexpr void lead_over(std::uint32_t ticks, auto& lead) {
    fill_lead(ticks, lead);
    sum_ = lead.inputs.sum;
    summed_ticks_ = ticks;
  }
  /// Adds the change between two measurements to a lead that begins at the second.
  static constexpr void prepend(const auto& since_last, auto& lead) {
    for (std::size_t i = 0; i < kInputs; ++i) {
      lead.inputs.change[i] += since_last.inputs.change[i];
      lead.inputs.unknown[i] += since_last.inputs.unknown[i];
    }
  }

  /// Adds the inputs to a drive. Its first `past` ticks lie in the lead and have the average there;
  /// the rest have the present inputs.
  static constexpr void over_drive(const auto& lead, std::uint32_t past, auto& drive) {
    const auto in_lead = static_cast<float>(std::max(lead.ticks, std::uint32_t{1}));
    const auto coming = static_cast<float>(drive.ticks - past);
    drive.inputs = lead.inputs;
    drive.inputs.change = {};
    for (std::size_t i = 0; i < kInputs; ++i) {
      drive.inputs.sum[i] =
          static_cast<float>(past) * lead.inputs.sum[i] / in_lead + coming * lead.inputs.change[i];
    }
  }

 private:
  static constexpr auto kTemperature = static_cast<std::size_t>(InputSource::thermometer);
  static constexpr auto kForce = static_cast<std::size_t>(InputSource::accelerometer);
  static constexpr auto kVibration = static_cast<std::size_t>(InputSource::vibration);

  constexpr void begin_tick(Instant at) {
    tick_.unknown_s[kTemperature] = thermometer_.unknown_s(at);
    const float e_k = thermometer_.above_reference_k();
    set(Input::temperature, e_k, tick_);
    set(Input::temperature_squared, e_k * e_k, tick_);
    set(Input::temperature_rate, thermometer_.rate_k_s(), tick_);
    if constexpr (Shape.has_accelerometer) {
      tick_.unknown_s[kForce] = accelerometer_.unknown_s(at);
      tick_.unknown_s[kVibration] =
          accelerometer_.has_vibration() ? tick_.unknown_s[kForce] : tick_s_;
      fill(tick_, accelerometer_.last_tick());
    }
  }
  constexpr void fill(Tick& tick, const Accelerometer::Figures& figures) const {
    set(Input::acceleration_x, figures.mean_g[0], tick);
    set(Input::acceleration_y, figures.mean_g[1], tick);
    set(Input::acceleration_z, figures.mean_g[2], tick);
    set(Input::vibration, figures.vibration_g2, tick);
  }
  constexpr void set(Input input, float value, Tick& tick) const {
    for (std::size_t i = 0; i < kInputs; ++i) {
      if (terms_.terms[i].input == input) tick.weights[i] = value;
    }
  }

  /// Change of the inputs from one tick to another so many ticks later. The change since an unknown
  /// beginning is unknown; the measurement there had the bias itself.
  [[nodiscard]] constexpr InputTransition<kInputs> between(const Tick& from, const Tick& to,
                                                           std::uint32_t ticks) const {
    InputTransition<kInputs> span;
    const float elapsed_s = static_cast<float>(ticks) * tick_s_;
    for (std::size_t i = 0; i < kInputs; ++i) {
      const Input input = terms_.terms[i].input;
      const InputSource source = source_of(input);
      if (from.is_known(source)) span.change[i] = to.weights[i] - from.weights[i];
      if (from.is_known(source) && to.is_known(source)) continue;
      const float unknown_s = from.is_known(source) ? to.unknown_for_s(source) : elapsed_s;
      span.unknown[i] = unknown_change(input, thermometer_.above_reference_k(), unknown_s);
    }
    return span;
  }

  const Terms& terms_;
  float tick_s_;
  Thermometer thermometer_;
  [[no_unique_address]] Force accelerometer_;
  Tick tick_{};
  Tick measured_{};
  std::array<float, kInputs> sum_{};
  std::uint32_t summed_ticks_ = 0;
};

/// No-op in a filter without inputs. It costs nothing without an accelerometer.
template <ModelShape Shape>
requires(Shape.inputs == 0) class InputTrack<Shape> {
 public:
  static constexpr std::size_t kInputs = 0;
  using Tick = TickInputs<Shape>;
  using Force = AccelerometerOf<Shape.has_accelerometer>;
  using State = typename Force::State;
  struct Lead {
    std::uint32_t ticks = 0;
  };
  constexpr InputTrack(NoInputTerms /*terms*/, Duration /*tick*/) {}
  [[nodiscard]] constexpr State state() const { return accelerometer_.state(); }
  constexpr void restore(const State& state) { accelerometer_.restore(state); }
  [[nodiscard]] static bool is_possible(const State& state) { return Force::is_possible(state); }
  constexpr void take(Instant at, bool begins_tick, float /*degc*/) {
    if (begins_tick) accelerometer_.begin_tick(at);
  }
  constexpr void take(const GyroSample& sample, bool begins_tick) {
    take(sample.time, begins_tick, 0.0F);
    if (sample.has_acceleration) take_acceleration(sample.time, sample.acceleration);
  }
  constexpr void take_acceleration(Instant at, const std::array<Acceleration, 3>& acceleration) {
    accelerometer_.take(at, acceleration);
  }
  [[nodiscard]] constexpr const Force& accelerometer() const { return accelerometer_; }
  [[nodiscard]] constexpr auto tick_force() const { return accelerometer_.tick_force(); }
  [[nodiscard]] constexpr Tick tick() const { return {}; }
  [[nodiscard]] constexpr Tick measurement() const { return {}; }
  [[nodiscard]] constexpr Tick measured() const { return {}; }
  [[nodiscard]] static constexpr Tick measured(const State& /*state*/) { return {}; }
  constexpr void resume(Tick /*measured*/) {}
  [[nodiscard]] constexpr bool misses_temperature(Instant /*now*/) const { return false; }
  [[nodiscard]] constexpr bool misses_acceleration(Instant /*now*/) const { return false; }
  constexpr void measure(Tick /*tick*/, std::uint32_t /*ticks*/, auto& /*since_last*/) {}
  constexpr void fill_lead(std::uint32_t /*ticks*/, auto& /*lead*/) const {}
  constexpr void lead_over(std::uint32_t /*ticks*/, auto& /*lead*/) {}
  static constexpr void prepend(const auto& /*since_last*/, auto& /*lead*/) {}
  static constexpr void over_drive(const auto& /*lead*/, std::uint32_t /*past*/, auto& /*drive*/) {}

 private:
  [[no_unique_address]] Force accelerometer_;
};

}  // namespace zerorate::core
