/// @file
/// The temperature of the sensing element, tick by tick.
#pragma once

#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"

namespace zerorate::core {

/// Mean of the readings of the tick before, followed by the lag of the sensing element. So the
/// temperature of a tick is known when it begins, and is the same for its prediction and its
/// measurement.
///
/// A reading counts until the next one, but no longer than kHold. A reading that is not finite, or
/// that no working silicon has, is ignored.
class Thermometer {
 public:
  static constexpr Duration kHold = Duration::seconds(5);
  static constexpr float kRateTime_s = 60.0F;  ///< smoothing of the rate of change

  struct State {
    bool has_started = false;
    bool has_reading = false;
    Instant newest;          ///< reading, or the first sample
    Instant tick;            ///< began then
    float reading_k = 0.0F;  ///< above the reference: the mean of the last tick with readings
    float element_k = 0.0F;  ///< the sensing element, behind it
    float smooth_k = 0.0F;   ///< the sensing element, smoothed over kRateTime_s
    float sum_k = 0.0F;      ///< sum of the readings of this tick
    std::uint32_t count = 0;

    constexpr bool operator==(const State&) const = default;
  };

  constexpr Thermometer(float reference_degc, float lag_s)
      : reference_degc_(reference_degc), lag_s_(lag_s) {}

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// True if a restored state is valid.
  [[nodiscard]] static bool is_possible(const State& state) {
    return are_bools(state.has_started, state.has_reading) && is_in_range(state.newest) &&
           is_in_range(state.tick) && is_plausible_rate(state.reading_k) &&
           is_plausible_rate(state.element_k) && is_plausible_rate(state.smooth_k) &&
           is_plausible(state.sum_k);
  }

  /// The time of every sample, and the temperature measured then: any number.
  constexpr void take(Instant at, bool begins_tick, float degc) {
    if (!state_.has_started) state_ = {.has_started = true, .newest = at, .tick = at};
    if (begins_tick) begin_tick(at);
    if (is_reading(degc)) add(at, degc - reference_degc_);
  }

  /// Sensing element above the reference [K]; the last known one.
  [[nodiscard]] constexpr float above_reference_k() const { return state_.element_k; }
  [[nodiscard]] constexpr float rate_k_s() const {
    return (state_.element_k - state_.smooth_k) / kRateTime_s;
  }
  /// Time since the newest reading, or the start; 0 while readings come.
  [[nodiscard]] constexpr float unknown_s(Instant now) const {
    return is_known(now) ? 0.0F : (now - state_.newest).in_seconds();
  }
  [[nodiscard]] constexpr bool is_known(Instant now) const {
    return state_.has_reading && now - state_.newest <= kHold;
  }

 private:
  static constexpr bool is_reading(float degc) {
    constexpr float kColdest = -100.0F;
    constexpr float kHottest = 250.0F;
    return degc > kColdest && degc < kHottest;
  }

  constexpr void begin_tick(Instant at) {
    if (state_.count > 0) state_.reading_k = state_.sum_k / static_cast<float>(state_.count);
    if (is_known(at)) follow(at - state_.tick);
    state_.sum_k = 0.0F;
    state_.count = 0;
    state_.tick = at;
  }
  constexpr void add(Instant at, float excess_k) {
    if (!is_known(at)) {
      state_.reading_k = excess_k;
      if (state_.has_reading) {
        follow(at - state_.newest);
      } else {
        state_.element_k = state_.smooth_k = excess_k;
      }
      state_.has_reading = true;
    }
    state_.newest = at;
    state_.sum_k += excess_k;
    ++state_.count;
  }
  constexpr void follow(Duration elapsed) {
    const float elapsed_s = elapsed.in_seconds();
    const float share = lag_s_ > 0.0F ? one_minus_exp_neg(elapsed_s / lag_s_) : 1.0F;
    state_.element_k += share * (state_.reading_k - state_.element_k);
    const float smoothing = elapsed_s < kRateTime_s ? elapsed_s / kRateTime_s : 1.0F;
    state_.smooth_k += smoothing * (state_.element_k - state_.smooth_k);
  }

  float reference_degc_;
  float lag_s_;
  State state_;
};

}  // namespace zerorate::core
