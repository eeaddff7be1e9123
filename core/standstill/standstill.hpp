/// @file
/// Still or moving, from odometer pulses and a clock.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"

namespace zerorate::core {

/// Source of the word that the vehicle stands.
enum class StandstillSource : std::uint8_t {
  odometer,        ///< no pulse; and then the gyro, which may find motion all the same
  gyro,            ///< the calm of the gyro alone: there is no odometer
  odometer_alone,  ///< no pulse, whatever the gyro shows: for an odometer without a dead band
};

enum class Motion : std::uint8_t {
  moving,    ///< a pulse arrived less than the settle time ago
  settling,  ///< no pulse for the settle time, but a sample does not count yet
  still,     ///< samples are being released as calibration data
};

/// The word for it in everything that people and programs read.
[[nodiscard]] constexpr std::string_view name(Motion motion) {
  constexpr std::array<std::string_view, 3> kNames{"moving", "settling", "still"};
  return kNames[static_cast<std::size_t>(motion)];
}

/// A wheel sensor is silent between two pulses, so "no pulse" is late at both ends of a stop: the
/// body still rocks after the last pulse, and already turns before the first one. Hence two times:
/// `settle` after a pulse nothing counts, and nothing counts until it is `hold_back` old and no
/// pulse has followed (HoldBackLine).
///
/// A vehicle that creeps may need longer than the settle time from pulse to pulse. So the silence
/// must also be twice as long as the one before the newest pulse, up to `slowest`. A contact that
/// bounces gives pulses in quick succession, which say nothing of the speed: each shortens that
/// silence by an eighth at most.
class Standstill {
 public:
  struct Params {
    /// Larger: less rocking in the calibration data, shorter stops. Default 1 s.
    Duration settle = Duration::seconds(1);
    /// The slowest creeping is a pulse in half this time. Larger: slower creeping is never taken
    /// for standstill; but so long a single pulse within a stop interrupts it. Default 8 s.
    Duration slowest = Duration::seconds(8);
    /// Larger: surer that a sample does not belong to the start of the next drive. Default 0.5 s.
    Duration hold_back = Duration::milliseconds(500);
    StandstillSource source = StandstillSource::odometer;
  };
  struct State {
    Instant last_pulse;  ///< or the start: until the settle time has passed nothing is known
    Duration silence;    ///< silence needed after it, if longer than the settle time
    bool started = false;

    constexpr bool operator==(const State&) const = default;
  };

  /// @param params must outlive this
  constexpr explicit Standstill(const Params& params) : params_(params) {}

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// Whether memory from outside may be such a state.
  [[nodiscard]] static bool is_possible(const State& state) {
    constexpr Duration kLongest = Duration::seconds(1'000'000'000);
    return is_bool(state.started) && is_in_range(state.last_pulse) && state.silence >= Duration{} &&
           state.silence <= kLongest;
  }

  /// The clock's first reading: the vehicle may have been moving just before.
  constexpr void start(Instant now) {
    if (state_.started) return;
    state_ = {.last_pulse = now, .silence = {}, .started = true};
  }

  /// Pulses may come late and out of order; the newest counts.
  constexpr void pulse(Instant at) {
    if (!state_.started) return start(at);
    if (at < state_.last_pulse) return;
    const Duration since = at - state_.last_pulse;
    const Duration silence = since < params_.slowest / 2 ? since * 2 : params_.slowest;
    const Duration shortest = since < kLongestBounce ? state_.silence * 7 / 8 : Duration{};
    state_.silence = std::max(silence, shortest);
    state_.last_pulse = at;
  }

  /// Whether a sample of this time lies behind the settle time of every pulse so far.
  [[nodiscard]] constexpr bool is_settled(Instant at) const {
    return state_.started && at - state_.last_pulse >= needed_silence();
  }

  [[nodiscard]] constexpr Motion motion(Instant now) const {
    if (!is_settled(now)) return Motion::moving;
    const Duration settled = now - state_.last_pulse - needed_silence();
    return settled >= params_.hold_back ? Motion::still : Motion::settling;
  }

  /// Time after which a measurement may already belong to the drive whose pulse came at `at`; for
  /// HoldBackLine::discard_after().
  [[nodiscard]] constexpr Instant discard_after(Instant at) const { return at - params_.hold_back; }

 private:
  static constexpr Duration kLongestBounce = Duration::milliseconds(20);

  [[nodiscard]] constexpr Duration needed_silence() const {
    return std::max(params_.settle, state_.silence);
  }

  const Params& params_;
  State state_;
};

}  // namespace zerorate::core
