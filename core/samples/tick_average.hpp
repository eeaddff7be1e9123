/// @file
/// The front end of the predictors: means over the filter's ticks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"

namespace zerorate::core {

/// The mean of the samples of one tick.
template <std::size_t Axes>
struct TickMean {
  std::uint32_t tick = 0;
  std::uint32_t samples = 0;
  Instant end;  ///< time of the newest sample
  std::array<float, Axes> rate_rad_s{};

  constexpr bool operator==(const TickMean&) const = default;
};

/// Sorts time-stamped samples into ticks of equal length, so that the filter may run slower than
/// the sensor, and so that jitter, lost samples and a clock that is a little off do no harm: a tick
/// with fewer samples is a mean with a larger variance, a tick without samples is a gap.
///
/// Averaging is exact for the white noise and costs nothing of the 1/f noise as long as the tick is
/// short against 1 / (white-flicker corner frequency).
template <std::size_t Axes>
class TickAverage {
 public:
  struct State {
    bool started = false;
    Instant origin;          ///< the first tick begins half a sample before the first sample
    std::uint32_t tick = 0;  ///< being filled
    std::uint32_t samples = 0;
    Instant end;
    std::array<float, Axes> first_rad_s{};  ///< the tick's first sample: the sum is relative to it
    std::array<float, Axes> sum_rad_s{};

    constexpr bool operator==(const State&) const = default;
  };

  constexpr TickAverage(Duration tick, Duration sample_period)
      : tick_(tick), half_sample_(sample_period / 2) {}

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// Whether memory from outside may be the state of such an average whose newest sample came then.
  [[nodiscard]] static bool is_possible(const State& state, Duration tick, bool has_sample,
                                        Instant newest) {
    if (!is_bool(state.started) || state.started != has_sample) return false;
    if (!are_plausible(state.first_rad_s) || !are_plausible(state.sum_rad_s)) return false;
    if (!is_in_range(state.origin) || !is_in_range(state.end)) return false;
    if (state.samples > 0 && state.end > newest) return false;
    if (!has_sample) return state.tick == 0 && state.samples == 0;
    const std::int64_t ticks = (newest - state.origin) / tick;
    return state.origin <= newest && ticks < kMaxTicks && state.tick == ticks;
  }
  /// Whether a mean may be that of a tick of such a state, whose newest sample came then.
  [[nodiscard]] static constexpr bool is_possible(const State& state, const TickMean<Axes>& mean,
                                                  Instant newest) {
    return mean.samples > 0 && are_plausible(mean.rate_rad_s) && mean.tick <= state.tick &&
           mean.end >= state.origin && mean.end <= newest;
  }
  [[nodiscard]] constexpr std::uint32_t tick() const { return state_.tick; }

  /// The tick that holds this time; not before the first sample.
  [[nodiscard]] constexpr std::uint32_t tick_of(Instant at) const {
    // Nearly always the tick being filled, for which nothing is divided.
    if (is_being_filled_at(at)) return state_.tick;
    return static_cast<std::uint32_t>((at - state_.origin) / tick_);
  }

  /// Whether a sample of this time can still be given a tick: not before the first one, and within
  /// the 2^31 ticks (7 years at 10 Hz) that a counter holds.
  [[nodiscard]] constexpr bool can_take(Instant at) const {
    return !state_.started || is_being_filled_at(at) ||
           (at >= state_.origin && (at - state_.origin) / tick_ < kMaxTicks);
  }

  [[nodiscard]] constexpr bool is_empty() const { return state_.samples == 0; }

  /// Whether this time lies in a later tick than the one being filled; then close() it first.
  [[nodiscard]] constexpr bool is_over_at(Instant at) const {
    return state_.started && tick_of(at) != state_.tick;
  }

  /// Turns to the tick of this time, which becomes the one being filled.
  constexpr void enter(Instant at) {
    if (!state_.started) state_ = {.started = true, .origin = at - half_sample_};
    state_.tick = tick_of(at);
  }

  /// Adds a sample to the tick that enter() turned to.
  constexpr void add(Instant at, const std::array<float, Axes>& rate_rad_s) {
    if (state_.samples == 0) state_.first_rad_s = rate_rad_s;
    state_.end = at;
    ++state_.samples;
    for (std::size_t i = 0; i < Axes; ++i) {
      state_.sum_rad_s[i] += rate_rad_s[i] - state_.first_rad_s[i];
    }
  }

  /// Forgets the samples of the tick being filled.
  constexpr void clear() {
    state_.samples = 0;
    state_.sum_rad_s = {};
  }

  /// The mean of the tick being filled, which is then empty.
  constexpr TickMean<Axes> close() {
    TickMean<Axes> mean{.tick = state_.tick, .samples = state_.samples, .end = state_.end};
    for (std::size_t i = 0; i < Axes; ++i) {
      mean.rate_rad_s[i] =
          state_.first_rad_s[i] + state_.sum_rad_s[i] / static_cast<float>(state_.samples);
    }
    clear();
    return mean;
  }

 private:
  static constexpr std::int64_t kMaxTicks = std::int64_t{1} << 31U;

  [[nodiscard]] constexpr bool is_being_filled_at(Instant at) const {
    const Duration since = at - (state_.origin + tick_ * state_.tick);
    return since >= Duration{} && since < tick_;
  }

  Duration tick_;
  Duration half_sample_;
  State state_{};
};

}  // namespace zerorate::core
