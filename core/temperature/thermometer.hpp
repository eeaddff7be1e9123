/// @file
/// The temperature of the sensing element, tick by tick.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"
#include "core/noise/temperature_drift.hpp"

namespace zerorate::core {

/// Temperature during a tick of the filter, as far as it is known.
template <std::size_t K>
struct TickTemperature {
  std::array<float, K> weights{};  ///< e and e^2, e above the reference; the last known ones
  Instant at;                      ///< where the tick began
  bool is_known = false;
  /// The bytes up to the next member. A record holds them, so they are the same on every processor.
  std::array<std::uint8_t, 7> reserved{};
  Instant unknown_since;  ///< the last reading, or the start; only where it is not known

  constexpr bool operator==(const TickTemperature&) const = default;
  /// Sets the temperature above the reference [K]; not a number: unknown.
  [[nodiscard]] static constexpr TickTemperature of(float above_reference_k) {
    if (!is_finite(above_reference_k)) return {};
    return {.weights = {above_reference_k, above_reference_k * above_reference_k},
            .is_known = true};
  }
  /// True if a restored temperature is valid.
  [[nodiscard]] static bool is_possible(const TickTemperature& tick) {
    return is_bool(tick.is_known) && is_in_range(tick.at) && is_in_range(tick.unknown_since) &&
           are_plausible(tick.weights);
  }
};
template <>
struct TickTemperature<0> {
  constexpr bool operator==(const TickTemperature&) const = default;
  [[nodiscard]] static constexpr bool is_possible(const TickTemperature& /*tick*/) { return true; }
};

/// Makes weights of temperature readings: the mean of the readings of the tick before, followed by
/// the lag of the sensing element. So the weights of a tick are known when it begins, and are the
/// same for its prediction and its measurement.
///
/// A reading counts until the next one, but no longer than kHold. From then on the temperature is
/// unknown, and wanders by kWander_k2_per_s. A reading that is not finite, or that no working
/// silicon has, is ignored.
template <std::size_t K>
class Thermometer {
 public:
  static constexpr Duration kHold = Duration::seconds(5);
  /// 0.1 K in a second, 0.8 K in a minute, 6 K in an hour: a car's cabin.
  static constexpr float kWander_k2_per_s = 0.01F;

  struct State {
    bool has_started = false;
    bool has_reading = false;
    Instant newest;          ///< reading, or the first sample
    Instant tick;            ///< began then
    float reading_k = 0.0F;  ///< above the reference: the mean of the last tick with readings
    float element_k = 0.0F;  ///< the sensing element, behind it
    float sum_k = 0.0F;      ///< sum of the readings of this tick
    std::uint32_t count = 0;

    constexpr bool operator==(const State&) const = default;
  };

  constexpr explicit Thermometer(const TemperatureDrift& drift) : drift_(drift) {}

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// True if a restored state is valid.
  [[nodiscard]] static bool is_possible(const State& state) {
    return are_bools(state.has_started, state.has_reading) && is_in_range(state.newest) &&
           is_in_range(state.tick) && is_plausible_rate(state.reading_k) &&
           is_plausible_rate(state.element_k) && is_plausible(state.sum_k);
  }

  /// The time of every sample, and the temperature measured then: any number.
  constexpr void take(Instant at, bool begins_tick, float degc) {
    if (!state_.has_started) state_ = {.has_started = true, .newest = at, .tick = at};
    if (begins_tick) begin_tick(at);
    if (is_reading(degc)) add(at, degc - drift_.reference_degc);
  }

  /// The temperature of the tick that began with this sample.
  [[nodiscard]] constexpr TickTemperature<K> tick(Instant at) const {
    const float e = state_.element_k;
    return {
        .weights = {e, e * e}, .at = at, .is_known = is_known(at), .unknown_since = state_.newest};
  }

  /// Whether the model needs a temperature and none is known.
  [[nodiscard]] constexpr bool is_missed(Instant now) const {
    return drift_.is_on() && !is_known(now);
  }

  /// Change of the temperature from one tick to a later one.
  [[nodiscard]] static constexpr TemperatureTransition<K> between(const TickTemperature<K>& from,
                                                                  const TickTemperature<K>& to) {
    TemperatureTransition<K> span;
    if (from.is_known) {
      for (std::size_t i = 0; i < K; ++i) span.change[i] = to.weights[i] - from.weights[i];
    }
    if (!from.is_known || !to.is_known) {
      // The change since an unknown beginning is unknown; the measurement there had the bias
      // itself.
      const Duration unknown = to.at - (from.is_known ? to.unknown_since : from.at);
      const float sigma_k = square_root(kWander_k2_per_s * unknown.in_seconds());
      span.unknown = {sigma_k, 2.0F * to.weights[0] * sigma_k};
    }
    return span;
  }

 private:
  static constexpr bool is_reading(float degc) {
    constexpr float kColdest = -100.0F;
    constexpr float kHottest = 250.0F;
    return degc > kColdest && degc < kHottest;
  }
  [[nodiscard]] constexpr bool is_known(Instant now) const {
    return state_.has_reading && now - state_.newest <= kHold;
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
        state_.element_k = excess_k;
      }
      state_.has_reading = true;
    }
    state_.newest = at;
    state_.sum_k += excess_k;
    ++state_.count;
  }
  constexpr void follow(Duration elapsed) {
    const float share =
        drift_.lag_s > 0.0F ? one_minus_exp_neg(elapsed.in_seconds() / drift_.lag_s) : 1.0F;
    state_.element_k += share * (state_.reading_k - state_.element_k);
  }

  TemperatureDrift drift_;
  State state_;
};

}  // namespace zerorate::core
