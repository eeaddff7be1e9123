/// @file
/// The specific force on the chip, tick by tick.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"
#include "core/base/units.hpp"

namespace zerorate::core {

/// Specific force along x, y, z of the chip [g].
using SpecificForce = std::array<float, 3>;

/// Specific force of a tick.
struct TickForce {
  SpecificForce mean_g{};
  float variance_g2 = 0.0F;    ///< variance of a reading, summed over the axes
  std::uint32_t readings = 0;  ///< 0: it was not measured
};
/// Place of a TickForce in a node without an accelerometer.
struct NoForce {};

/// Mean and variance of the specific force over a tick. A reading that is not finite, or beyond
/// what an accelerometer measures, is ignored. The last mean counts for kHold without a reading.
class Accelerometer {
 public:
  static constexpr Duration kHold = Duration::seconds(1);
  static constexpr std::uint32_t kFewest = 4;  ///< readings of a tick that show a vibration

  struct State {
    SpecificForce mean_g{};       ///< mean of the newest tick with readings
    SpecificForce sum_g{};        ///< sum of the readings of this tick, less that mean each
    float sum_squares_g2 = 0.0F;  ///< squares of the same differences, summed over the axes
    float vibration_g2 = 0.0F;    ///< variance within the newest tick that had enough readings
    Instant newest;               ///< reading, or the first tick
    std::uint32_t count = 0;      ///< readings of this tick
    bool has_started = false;
    bool has_reading = false;
    bool has_vibration = false;  ///< the newest tick with readings had enough

    constexpr bool operator==(const State&) const = default;
  };
  /// The inputs of a tick.
  struct Figures {
    SpecificForce mean_g{};
    float vibration_g2 = 0.0F;
  };

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// True if a restored state is valid.
  [[nodiscard]] static bool is_possible(const State& state) {
    return are_plausible(state.mean_g) && are_plausible(state.sum_g) &&
           is_plausible_variance(state.sum_squares_g2) &&
           is_plausible_variance(state.vibration_g2) && is_in_range(state.newest) &&
           are_bools(state.has_started, state.has_reading, state.has_vibration);
  }

  /// A tick begins; the one before is over.
  constexpr void begin_tick(Instant at) {
    if (!state_.has_started) state_.newest = at;
    state_.has_started = true;
    if (state_.count == 0) return;
    const Figures over = this_tick();
    state_.has_vibration = shows_vibration();
    state_.mean_g = over.mean_g;
    state_.vibration_g2 = over.vibration_g2;
    state_.sum_g = {};
    state_.sum_squares_g2 = 0.0F;
    state_.count = 0;
  }
  constexpr void take(Instant at, const std::array<Acceleration, 3>& acceleration) {
    SpecificForce force_g{};
    for (std::size_t i = 0; i < force_g.size(); ++i) {
      force_g[i] = acceleration[i].in(standard_gravity);
    }
    take(at, force_g);
  }
  constexpr void take(Instant at, const SpecificForce& force_g) {
    if (!std::all_of(force_g.begin(), force_g.end(), is_reading)) return;
    if (!state_.has_reading) state_.mean_g = force_g;
    state_.has_reading = true;
    state_.newest = at;
    ++state_.count;
    for (std::size_t i = 0; i < force_g.size(); ++i) {
      const float difference = force_g[i] - state_.mean_g[i];
      state_.sum_g[i] += difference;
      state_.sum_squares_g2 += difference * difference;
    }
  }

  /// Figures of the newest tick that is over: what a tick is predicted with when it begins.
  [[nodiscard]] constexpr Figures last_tick() const { return {state_.mean_g, state_.vibration_g2}; }
  /// Figures of the tick being filled, as far as there are readings of it.
  [[nodiscard]] constexpr Figures this_tick() const {
    Figures figures = last_tick();
    if (state_.count == 0) return figures;
    const auto count = static_cast<float>(state_.count);
    float squares_g2 = state_.sum_squares_g2;
    for (std::size_t i = 0; i < figures.mean_g.size(); ++i) {
      figures.mean_g[i] += state_.sum_g[i] / count;
      squares_g2 -= state_.sum_g[i] * state_.sum_g[i] / count;
    }
    if (shows_vibration()) figures.vibration_g2 = at_least_zero(squares_g2) / (count - 1.0F);
    return figures;
  }
  /// Specific force of the tick being filled, of its own readings alone.
  [[nodiscard]] constexpr TickForce tick_force() const {
    const Figures figures = this_tick();
    return {figures.mean_g, shows_vibration() ? figures.vibration_g2 : 0.0F, state_.count};
  }
  /// Whether a tick had enough readings to show its vibration.
  [[nodiscard]] constexpr bool has_vibration() const { return state_.has_vibration; }
  [[nodiscard]] constexpr bool shows_vibration() const { return state_.count >= kFewest; }

  /// Time since the newest reading, or the start; 0 while readings come.
  [[nodiscard]] constexpr float unknown_s(Instant now) const {
    return is_known(now) ? 0.0F : (now - state_.newest).in_seconds();
  }
  [[nodiscard]] constexpr bool is_known(Instant now) const {
    return state_.has_reading && now - state_.newest <= kHold;
  }

  /// Whether an axis of an accelerometer can have measured it.
  [[nodiscard]] static constexpr bool is_reading(float force_g) {
    constexpr float kLargest_g = 1000.0F;
    return force_g >= -kLargest_g && force_g <= kLargest_g;
  }

 private:
  static constexpr float at_least_zero(float x) { return x > 0.0F ? x : 0.0F; }

  State state_;
};

/// Place of an Accelerometer in a node without one.
struct NoAccelerometer {
  struct State {
    constexpr bool operator==(const State&) const = default;
  };
  [[nodiscard]] constexpr State state() const { return {}; }
  constexpr void restore(State /*state*/) {}
  [[nodiscard]] static constexpr bool is_possible(State /*state*/) { return true; }
  constexpr void begin_tick(Instant /*at*/) {}
  constexpr void take(Instant /*at*/, const std::array<Acceleration, 3>& /*acceleration*/) {}
  [[nodiscard]] constexpr NoForce tick_force() const { return {}; }
};

template <bool HasAccelerometer>
using AccelerometerOf = std::conditional_t<HasAccelerometer, Accelerometer, NoAccelerometer>;

}  // namespace zerorate::core
