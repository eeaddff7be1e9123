/// @file
/// The temperature between the newest measurement and now.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/temperature/thermometer.hpp"

namespace zerorate::core {

/// Adds the temperature to the spans of a filter that measures at some ticks and predicts at
/// others.
template <std::size_t K>
class TemperatureTrack {
 public:
  using Tick = TickTemperature<K>;
  struct State {
    typename Thermometer<K>::State thermometer;
    Tick tick;                   ///< being filled
    Tick measured;               ///< temperature of the newest measurement
    std::array<float, K> sum{};  ///< sum over the ticks of the changes since then
    std::uint32_t summed_ticks = 0;

    constexpr bool operator==(const State&) const = default;
  };

  constexpr explicit TemperatureTrack(const TemperatureDrift& drift) : thermometer_(drift) {}

  [[nodiscard]] constexpr State state() const {
    return {thermometer_.state(), tick_, measured_, sum_, summed_ticks_};
  }
  constexpr void restore(const State& state) {
    thermometer_.restore(state.thermometer);
    tick_ = state.tick;
    measured_ = state.measured;
    sum_ = state.sum;
    summed_ticks_ = state.summed_ticks;
  }

  /// True if a restored state is valid.
  [[nodiscard]] static bool is_possible(const State& state) {
    return Thermometer<K>::is_possible(state.thermometer) && Tick::is_possible(state.tick) &&
           Tick::is_possible(state.measured) && are_plausible(state.sum);
  }

  /// Every sample; see Thermometer.
  constexpr void take(Instant at, bool begins_tick, float degc) {
    thermometer_.take(at, begins_tick, degc);
    if (begins_tick) tick_ = thermometer_.tick(at);
  }
  [[nodiscard]] constexpr const Tick& tick() const { return tick_; }
  [[nodiscard]] constexpr const Tick& measured() const { return measured_; }
  [[nodiscard]] static constexpr Tick measured(const State& state) { return state.measured; }
  [[nodiscard]] constexpr bool is_missed(Instant now) const { return thermometer_.is_missed(now); }

  /// A tick is measured; `since_last` is the span from the measurement before.
  constexpr void measure(const Tick& tick, auto& since_last) {
    since_last.temperature = Thermometer<K>::between(measured_, tick);
    measured_ = tick;
    sum_ = {};
    summed_ticks_ = 0;
  }

  /// Continues from the last temperature of another run, whose clock is unrelated.
  constexpr void resume(const Tick& measured) {
    measured_ = measured;
    measured_.at = {};
  }

  /// Fills in a lead of so many ticks, from the newest measurement to the tick being filled. What
  /// is held back counts as what is new.
  constexpr void fill_lead(std::uint32_t ticks, auto& lead) const {
    lead.temperature = Thermometer<K>::between(measured_, tick_);
    const auto more = static_cast<float>(ticks - summed_ticks_);
    for (std::size_t i = 0; i < K; ++i) {
      lead.temperature.sum[i] = sum_[i] + more * lead.temperature.change[i];
    }
  }
  /// fill_lead() once a tick; the next sum goes on from this one.
  constexpr void lead_over(std::uint32_t ticks, auto& lead) {
    fill_lead(ticks, lead);
    sum_ = lead.temperature.sum;
    summed_ticks_ = ticks;
  }
  /// Adds the change between two measurements to a lead that begins at the second.
  static constexpr void prepend(const auto& since_last, auto& lead) {
    for (std::size_t i = 0; i < K; ++i) {
      lead.temperature.change[i] += since_last.temperature.change[i];
      lead.temperature.unknown[i] += since_last.temperature.unknown[i];
    }
  }

  /// Adds the temperature to a drive. Its first `past` ticks lie in the lead and have the average
  /// there; the rest have the present temperature.
  static constexpr void over_drive(const auto& lead, std::uint32_t past, auto& drive) {
    const auto in_lead = static_cast<float>(std::max(lead.ticks, std::uint32_t{1}));
    const auto coming = static_cast<float>(drive.ticks - past);
    drive.temperature = lead.temperature;
    drive.temperature.change = {};
    for (std::size_t i = 0; i < K; ++i) {
      drive.temperature.sum[i] = static_cast<float>(past) * lead.temperature.sum[i] / in_lead +
                                 coming * lead.temperature.change[i];
    }
  }

 private:
  Thermometer<K> thermometer_;
  Tick tick_{};
  Tick measured_{};
  std::array<float, K> sum_{};
  std::uint32_t summed_ticks_ = 0;
};

/// No-op in a filter without temperature, at no cost.
template <>
class TemperatureTrack<0> {
 public:
  using Tick = TickTemperature<0>;
  struct State {
    constexpr bool operator==(const State&) const = default;
  };
  constexpr explicit TemperatureTrack(NoTemperatureDrift /*drift*/) {}
  [[nodiscard]] constexpr State state() const { return {}; }
  constexpr void restore(State /*state*/) {}
  [[nodiscard]] static constexpr bool is_possible(State /*state*/) { return true; }
  constexpr void take(Instant /*at*/, bool /*begins_tick*/, float /*degc*/) {}
  [[nodiscard]] constexpr Tick tick() const { return {}; }
  [[nodiscard]] constexpr Tick measured() const { return {}; }
  [[nodiscard]] static constexpr Tick measured(State /*state*/) { return {}; }
  constexpr void resume(Tick /*measured*/) {}
  [[nodiscard]] constexpr bool is_missed(Instant /*now*/) const { return false; }
  constexpr void measure(Tick /*tick*/, auto& /*since_last*/) {}
  constexpr void fill_lead(std::uint32_t /*ticks*/, auto& /*lead*/) const {}
  constexpr void lead_over(std::uint32_t /*ticks*/, auto& /*lead*/) {}
  static constexpr void prepend(const auto& /*since_last*/, auto& /*lead*/) {}
  static constexpr void over_drive(const auto& /*lead*/, std::uint32_t /*past*/, auto& /*drive*/) {}
};

}  // namespace zerorate::core
