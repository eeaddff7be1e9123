/// @file
/// Turn since departure: the sum of the corrected rate while the vehicle moves, with its error.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"
#include "core/base/units.hpp"

namespace zerorate::core {

/// Errors of a gyro that rest does not show, as standard deviations relative to the rate: 0.01 is
/// 1 %. An axis that is mounted askew by an angle acts as a scale factor of its cosine.
struct MotionModel {
  static constexpr float kRoom_k = 298.15F;  ///< 25 deg C, as data sheets state tolerances

  float scale_factor = 0.01F;  ///< error of the scale factor; the tolerance of many data sheets
  float asymmetry = 0.0F;      ///< half the difference between the scale factors of both senses
  /// Variance of the turn that a slope feigns on a tilted axis, at either end of a drive.
  float slope_variance_rad2 = 0.0F;
  float scale_factor_per_k = 1e-4F;   ///< change of the scale factor with the temperature
  float scale_factor_at_k = kRoom_k;  ///< temperature at which the tolerance holds

  constexpr bool operator==(const MotionModel&) const = default;

  /// Variance of the scale factor at a temperature [K]; 0: not known, as where the tolerance holds.
  [[nodiscard]] constexpr float scale_variance(float temperature_k) const {
    const float away_k = temperature_k > 0.0F ? temperature_k - scale_factor_at_k : 0.0F;
    const float change = scale_factor_per_k * away_k;
    return scale_factor * scale_factor + change * change;
  }
};

/// Adds up the corrected rates of the axes from a departure on.
///
/// A departure is the first motion after a stop from which the bias was learnt. A shorter stop
/// interrupts the sum and does not begin it anew. Motion is noticed late: a turn without pulses
/// after one or two windows of the gyro's noise. So the sum begins up to two windows before it.
///
/// The error of the sum M over n samples at the intervals dt has the variance
///
///     bias + N^2 n dt^2 + scale_factor^2 M^2 + asymmetry^2 (sum |M of a tick|)^2 + gaps
///
/// docs/design/heading.md. The variance of the bias part is set by the owner now and then; in
/// between its standard deviation grows by that of the bias, which is an upper bound.
///
/// Fixed memory; cost of a sample: 12 floating-point operations an axis.
template <std::size_t Axes>
class TurnSum {
 public:
  using Rates = std::array<float, Axes>;

  /// Turn of each axis in a window at rest.
  struct Window {
    Rates turn_rad{};
    float length_s = 0.0F;
    float gap_variance_rad2 = 0.0F;

    constexpr bool operator==(const Window&) const = default;
  };
  struct State {
    Duration duration;               ///< time that is summed since departure
    Window before;                   ///< at rest: the newest window
    Window long_before;              ///< at rest: the window before
    Rates tick_rad{};                ///< turn in the tick being filled
    Rates sum_rad{};                 ///< since departure, to the tick being filled
    Rates lost_rad{};                ///< digits that the sum has lost
    Rates path_rad{};                ///< sum of the magnitudes of the turns of ticks
    Rates bias_sigma_rad{};          ///< deviation of the integral of the bias
    Rates white_variance_rad2_s2{};  ///< variance of a sample
    Rates newest_rad_s{};            ///< rates of the newest sample
    Rates slow_variance_rad2{};      ///< white noise, asymmetry and gaps, to the tick being filled
    float scale_variance = 0.0F;     ///< variance of the scale factor at departure
    float gap_variance_rad2 = 0.0F;
    std::uint32_t measured_ticks = 0;  ///< ticks up to the stop that was departed from
    std::uint8_t lost_axes = 0;        ///< bit i: axis i was at full scale
    bool moves = false;
    bool has_departed = false;

    constexpr bool operator==(const State&) const = default;
  };
  /// Sum of an axis at a time, in two parts whose differences are exact.
  struct Position {
    float sum_rad = 0.0F;
    float rest_rad = 0.0F;
    float length_s = 0.0F;       ///< time that is summed
    float variance_rad2 = 0.0F;  ///< white noise, asymmetry and gaps

    [[nodiscard]] constexpr float turn_since(const Position& before) const {
      return (sum_rad - before.sum_rad) + (rest_rad - before.rest_rad);
    }
    constexpr bool operator==(const Position&) const = default;
  };
  /// Circumstances of a sample.
  struct Sample {
    Duration since_last;  ///< zero: there is no sample before
    Rates rate_rad_s{};   ///< corrected
    Rates bias_sigma_rad_s{};
    std::uint8_t saturated_axes = 0;
    bool moves = false;
  };

  /// @param model must outlive the sum
  /// @param window longest time in which a motion without pulses is noticed
  constexpr TurnSum(const MotionModel& model, Duration sample_period, Duration window)
      : model_(model), period_s_(sample_period.in_seconds()), window_s_(window.in_seconds()) {}

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// Whether memory from outside may be such a state.
  [[nodiscard]] static bool is_possible(const State& state) {
    // Infinite where it is not known.
    for (const float sigma : state.bias_sigma_rad) {
      if (!(sigma >= 0.0F)) return false;
    }
    for (const float variance : state.white_variance_rad2_s2) {
      if (!is_plausible_variance(variance)) return false;
    }
    return are_bools(state.moves, state.has_departed) && state.duration >= Duration{} &&
           is_in_range(Instant{} + state.duration) && are_plausible(state.before.turn_rad) &&
           are_plausible(state.long_before.turn_rad) && are_plausible(state.tick_rad) &&
           are_plausible(state.sum_rad) && are_plausible(state.lost_rad) &&
           are_plausible(state.path_rad) && are_plausible(state.newest_rad_s) &&
           is_plausible_variance(state.before.length_s) &&
           is_plausible_variance(state.long_before.length_s) &&
           state.before.gap_variance_rad2 >= 0.0F && state.long_before.gap_variance_rad2 >= 0.0F &&
           is_plausible_variance(state.scale_variance) && state.gap_variance_rad2 >= 0.0F &&
           are_plausible_variances(state.slow_variance_rad2);
  }

  /// Whether the vehicle moves by the newest sample.
  [[nodiscard]] constexpr bool moves() const { return state_.moves; }
  /// Whether the next motion is a departure.
  [[nodiscard]] constexpr bool has_rested(std::uint32_t measured_ticks) const {
    return measured_ticks != state_.measured_ticks;
  }
  /// Notes the newest measurement while the vehicle moves: it belongs to the stop before.
  constexpr void note_measurement(std::uint32_t measured_ticks) {
    state_.measured_ticks = measured_ticks;
  }
  /// The vehicle begins to move after a stop from which the bias was learnt.
  /// @param white_variance_rad2_s2 variance of a sample of each axis
  /// @param temperature_k of the sensor; 0: not known
  constexpr void depart(const Rates& white_variance_rad2_s2, float temperature_k = 0.0F) {
    state_ = {.before = state_.before,
              .long_before = state_.long_before,
              .tick_rad = state_.tick_rad,
              .white_variance_rad2_s2 = white_variance_rad2_s2,
              .newest_rad_s = state_.newest_rad_s,
              .scale_variance = model_.scale_variance(temperature_k),
              .measured_ticks = state_.measured_ticks,
              .has_departed = true};
  }
  /// The turn since departure is lost: time passed in which nothing was measured.
  constexpr void lose() { state_.has_departed = false; }

  /// A tick ends with the newest sample.
  constexpr void close_tick() {
    if (state_.moves) {
      add(state_.tick_rad);
      sum_slow_variances();
    } else {
      for (std::size_t i = 0; i < Axes; ++i) state_.before.turn_rad[i] += state_.tick_rad[i];
      if (state_.before.length_s >= window_s_) {
        state_.long_before = state_.before;
        state_.before = {};
      }
    }
    state_.tick_rad = {};
  }

  /// Adds a sample. Call depart() before where it is the first of a drive. A gap that follows
  /// motion belongs to it: nothing shows when within the gap the vehicle stopped, or whether it
  /// did.
  constexpr void add(const Sample& sample) {
    const float interval_s = sample.since_last.in_seconds();
    const float gap_s = is_gap(interval_s) ? interval_s : 0.0F;
    const bool is_gap_in_motion = state_.moves && gap_s > 0.0F;
    if (sample.moves != state_.moves && !is_gap_in_motion)
      turn_to(sample.moves, sample.bias_sigma_rad_s);
    for (std::size_t i = 0; i < Axes; ++i) {
      state_.tick_rad[i] += 0.5F * interval_s * (state_.newest_rad_s[i] + sample.rate_rad_s[i]);
    }
    state_.newest_rad_s = sample.rate_rad_s;
    if (state_.moves) {
      add_error(sample, interval_s, gap_s);
    } else {
      state_.before.length_s += interval_s;
      if (gap_s > 0.0F) state_.before.gap_variance_rad2 += gap_variance_rad2(gap_s);
    }
    if (sample.moves != state_.moves) turn_to(sample.moves, sample.bias_sigma_rad_s);
  }

  /// Sets the bias part of the error.
  /// @param variance_rad2 of the integral of the bias over duration() or more
  constexpr void set_bias_variance(std::size_t axis, float variance_rad2) {
    state_.bias_sigma_rad[axis] = square_root(variance_rad2);
  }

  /// Time that is summed: the vehicle moves, or has not rested for long enough.
  [[nodiscard]] constexpr Duration duration() const { return state_.duration; }
  [[nodiscard]] constexpr Angle angle(std::size_t axis) const { return rad(turn_rad(axis)); }
  [[nodiscard]] constexpr Position position(std::size_t axis) const {
    const float tick = state_.moves ? state_.tick_rad[axis] : 0.0F;
    return {state_.sum_rad[axis], tick - state_.lost_rad[axis], state_.duration.in_seconds(),
            state_.slow_variance_rad2[axis]};
  }
  /// Takes off what is known now of the rates that are summed already.
  constexpr void correct(std::size_t axis, float turn_rad) { state_.sum_rad[axis] -= turn_rad; }
  /// Whether the turn of an axis since departure is known.
  [[nodiscard]] constexpr bool is_known(std::size_t axis) const {
    return state_.has_departed && ((state_.lost_axes >> axis) & 1U) == 0;
  }
  /// Variance of angle() by the tolerance of the scale factor.
  [[nodiscard]] constexpr float scale_variance_rad2(std::size_t axis) const {
    const float turned = turn_rad(axis);
    return turned * turned * state_.scale_variance;
  }
  /// Standard deviation of the error of angle(); infinite where it is not known.
  /// @param scale_variance_rad2 scale_variance_rad2(), or what is known better
  /// @param silence time since the newest sample
  [[nodiscard]] constexpr Angle sigma(std::size_t axis, float scale_variance_rad2,
                                      Duration silence = {}) const {
    if (!is_known(axis)) return rad(std::numeric_limits<float>::infinity());
    const float bias = state_.bias_sigma_rad[axis];
    float variance = bias * bias + scale_variance_rad2 + state_.slow_variance_rad2[axis];
    if (state_.moves && silence > Duration{} && is_gap(silence.in_seconds())) {
      variance += gap_variance_rad2(silence.in_seconds());
    }
    return rad(square_root(variance));
  }

 private:
  /// Variance of the turn in a gap between two known rates, if the rate wanders at random in
  /// between: q T^3 / 12. A car at a corner changes its rate by 20 deg/s within a second.
  [[nodiscard]] static constexpr float gap_variance_rad2(float gap_s) {
    constexpr float kChange_rad_s_per_sqrt_s = 20.0F * kRadPerDeg;
    constexpr float kIntensity = kChange_rad_s_per_sqrt_s * kChange_rad_s_per_sqrt_s / 12.0F;
    return kIntensity * gap_s * gap_s * gap_s;
  }

  [[nodiscard]] constexpr bool is_gap(float interval_s) const {
    return interval_s > 1.5F * period_s_;
  }
  [[nodiscard]] constexpr float turn_rad(std::size_t axis) const {
    const float tick = state_.moves ? state_.tick_rad[axis] : 0.0F;
    return state_.sum_rad[axis] + (tick - state_.lost_rad[axis]);
  }
  /// Adds to the sum since departure, which an hour at 1 kHz must not round (Kahan).
  constexpr void add(const Rates& turn_rad) {
    for (std::size_t i = 0; i < Axes; ++i) {
      const float term = turn_rad[i] - state_.lost_rad[i];
      const float sum = state_.sum_rad[i] + term;
      state_.lost_rad[i] = (sum - state_.sum_rad[i]) - term;
      state_.sum_rad[i] = sum;
      state_.path_rad[i] += turn_rad[i] < 0.0F ? -turn_rad[i] : turn_rad[i];
    }
  }
  /// @param gap_s the interval where it is a gap, 0 elsewhere
  constexpr void add_error(const Sample& sample, float interval_s, float gap_s) {
    state_.duration = state_.duration + sample.since_last;
    grow_bias_sigma(interval_s, sample.bias_sigma_rad_s);
    state_.lost_axes |= sample.saturated_axes;
    if (!(gap_s > 0.0F)) return;
    state_.gap_variance_rad2 += gap_variance_rad2(gap_s);
    sum_slow_variances();
  }
  /// The parts of the error that a sample hardly changes.
  [[gnu::noinline]] constexpr void sum_slow_variances() {
    const float period_times_length_s2 = period_s_ * state_.duration.in_seconds();
    for (std::size_t i = 0; i < Axes; ++i) {
      const float path = state_.path_rad[i] * model_.asymmetry;
      state_.slow_variance_rad2[i] = state_.white_variance_rad2_s2[i] * period_times_length_s2 +
                                     path * path + state_.gap_variance_rad2;
    }
  }
  /// The vehicle begins to move, with what was turned unnoticed, or stops.
  [[gnu::noinline]] constexpr void turn_to(bool moves, const Rates& bias_sigma_rad_s) {
    close_tick();
    state_.moves = moves;
    if (!moves) return;
    add(state_.long_before.turn_rad);
    add(state_.before.turn_rad);
    state_.gap_variance_rad2 +=
        state_.long_before.gap_variance_rad2 + state_.before.gap_variance_rad2;
    const float length_s = state_.long_before.length_s + state_.before.length_s;
    constexpr float kMillisecondsPerSecond = 1e3F;
    state_.duration =
        state_.duration +
        Duration::milliseconds(static_cast<std::int32_t>(length_s * kMillisecondsPerSecond));
    sum_slow_variances();
    grow_bias_sigma(length_s, bias_sigma_rad_s);
    state_.before = {};
    state_.long_before = {};
  }
  /// The integral cannot have more: it is as if the error of the bias stayed the same.
  constexpr void grow_bias_sigma(float length_s, const Rates& bias_sigma_rad_s) {
    if (!(length_s > 0.0F)) return;  // the other factor may be infinite
    for (std::size_t i = 0; i < Axes; ++i) {
      state_.bias_sigma_rad[i] += length_s * bias_sigma_rad_s[i];
    }
  }

  const MotionModel& model_;
  float period_s_;  ///< nominal sample period; half as much again is a gap
  float window_s_;
  State state_{};
};

}  // namespace zerorate::core
