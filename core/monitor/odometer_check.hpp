/// @file
/// Contradictions between the odometer and the gyro, in fixed memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "core/samples/tick_window.hpp"

namespace zerorate::core {

/// Limits of what counts as a contradiction.
struct OdometerCheckParams {
  /// A change by more is a turn. Larger values tolerate rougher engines and noisier gyros;
  /// smaller values detect slower turns. Never below six standard deviations of the difference of
  /// a window from the level. Default 0.25 deg/s; infinite: no turn is ever noticed.
  float turn_rad_s = 0.25F * kRadPerDeg;
  /// A rate that has stayed changed for so long, or for four times as long as the one before it,
  /// is a bias that jumped, and is learnt. Longer than any turn that the odometer may miss.
  /// Default 2 min.
  Duration longest_turn = Duration::seconds(120);
  /// Shortest time before a changed level is accepted; used as it is where a stop begins away
  /// from the predicted bias. Default 5 s.
  Duration longest_bend = Duration::seconds(5);
  /// No vehicle drives for so long without any rotation that exceeds the noise. Default 2 min; 0:
  /// pulses are never doubted for that.
  Duration longest_straight = Duration::seconds(120);
  /// Pulses closer together than this cannot come from a turning wheel. Default 0.2 ms: a pulse
  /// each 2 cm at 100 m/s.
  Duration shortest_pulse = Duration::microseconds(200);
};

/// A dead odometer looks like a parked vehicle for ever, and one that counts by itself like a drive
/// for ever. The gyro shows the difference, but only by the *change* of its rate: the level is the
/// bias, which may be anything. So while no pulse comes, a change of the rate from one window to
/// the next is a turn, until the rate is back or has stayed where it is for too long for a turn;
/// and pulses without any change of the rate do not come from a vehicle that drives.
///
/// The level matters only where a stop begins: far from the predicted bias, or before there is one
/// from the stop before, it is either a bias that has changed, or the wire broke in a bend. Nothing
/// is refused for that; it must last a while.
///
/// A window lasts half a second, and until half of its nominal samples have come: where samples are
/// lost, or the sensor is slower than its nominal rate, it is judged by those that came. That of a
/// loud sensor goes on, up to two seconds, until the least turn exceeds six standard deviations of
/// its difference from the level, or until it shows a change that does. The level is the mean of
/// the windows since it changed, which forgets with a time constant of 15 s.
///
/// Fed with the means of the filter's ticks at standstill and with one sample a tick while moving;
/// some thirty floating-point operations each, and three divisions a window.
template <std::size_t Axes>
class OdometerCheck {
 public:
  using Rates = std::array<float, Axes>;

  using Params = OdometerCheckParams;
  struct State {
    Rates level_rad_s{};             ///< recent level of the rate; while moving, the newest sample
    Rates trusted_rad_s{};           ///< level before the last change, if there was one
    TickWindow<Axes> window;         ///< window being filled
    std::uint16_t steady_ticks = 0;  ///< ticks since the level changed
    std::uint16_t needed_ticks = 0;  ///< ticks until a changed level is believed
    std::uint8_t bounced_ticks = 0;  ///< ticks until the newest bounce is forgotten
    bool stands = false;             ///< the level is that of a stop
    bool turns = false;              ///< a rotation without pulses
    bool has_trusted = false;        ///< without a trusted level none counts as changed

    constexpr bool operator==(const State&) const = default;
  };

  /// @param white_variance_rad2_s2 of one sample, until it is known better
  constexpr OdometerCheck(const Params& params, Duration tick, Duration sample_period,
                          float white_variance_rad2_s2)
      : shortest_pulse_(params.shortest_pulse),
        longest_turn_(ticks_in(params.longest_turn, tick)),
        longest_bend_(ticks_in(params.longest_bend, tick)),
        longest_straight_(ticks_in(params.longest_straight, tick)),
        back_(ticks_in_u8(kBackFor, tick)),
        bounced_(ticks_in_u8(kBouncedFor, tick)),
        window_(window_ticks(tick)),
        longest_window_(ticks_in_u8(kLongestWindow, tick)),
        longest_memory_(ticks_in(kMemory, tick)),
        fewest_samples_(static_cast<std::uint32_t>(tick * window_ / (sample_period * 2))),
        least_turn_rad2_s2_(params.turn_rad_s * params.turn_rad_s) {
    set_white_noise(white_variance_rad2_s2);
  }

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// True if a restored state is valid.
  [[nodiscard]] static bool is_possible(const State& state) {
    return are_bools(state.stands, state.turns, state.has_trusted) &&
           are_plausible(state.level_rad_s) && are_plausible(state.trusted_rad_s) &&
           TickWindow<Axes>::is_possible(state.window) && state.steady_ticks < kNever;
  }

  /// The variance of one sample is known better now.
  constexpr void set_white_noise(float white_variance_rad2_s2) {
    white_rad2_s2_ = white_variance_rad2_s2;
    noise_rad2_s2_ = kFourSigmaOfDifference2 * white_variance_rad2_s2;
  }

  /// A rotation without pulses: what is measured is no bias.
  [[nodiscard]] constexpr bool turns() const { return state_.turns; }
  /// Anything at all contradicts the odometer.
  [[nodiscard]] constexpr bool disagrees() const {
    return state_.turns || state_.bounced_ticks > 0 ||
           (!state_.stands && state_.steady_ticks >= longest_straight_);
  }

  /// @param since the pulse before; any other sign or none: out of order, ignored
  constexpr void pulse(Duration since) {
    state_.turns = false;
    if (since > Duration{} && since < shortest_pulse_) state_.bounced_ticks = bounced_;
  }

  /// A tick begins while the vehicle moves.
  constexpr void on_driving_tick(const Rates& sample_rad_s) {
    count_down();
    if (state_.stands && !state_.turns) trust(state_.level_rad_s);
    if (state_.stands || !is_near(sample_rad_s, state_.level_rad_s, noise_rad2_s2_)) {
      restart_level(sample_rad_s);
    } else {
      age_level(1);
    }
    clear_window();
    state_.stands = false;
  }

  /// A tick of standstill is over.
  /// @param samples in it, at least one
  /// @param predicted_rad_s the bias, or nullptr if none is known
  constexpr void on_standing_tick(const Rates& mean_rad_s, std::uint32_t samples,
                                  const Rates* predicted_rad_s) {
    count_down();
    state_.window.add(mean_rad_s, samples);
    if (state_.window.ticks < window_ || state_.window.samples < fewest_samples_) return;
    judge(window(), predicted_rad_s);
  }

 private:
  static constexpr Duration kLongestWindow = Duration::seconds(2);  ///< window of a loud sensor
  static constexpr Duration kBackFor = Duration::seconds(1);        ///< then it is over
  static constexpr Duration kBouncedFor = Duration::seconds(2);     ///< it is reported for so long
  static constexpr Duration kMemory =
      Duration::seconds(15);  ///< memory of the level: a bias drifts
  static constexpr std::uint16_t kNever = 0xFFFF;
  // Six standard deviations of a difference are no noise, four may be, once in a while.
  static constexpr float kSixSigma2 = 6.0F * 6.0F;
  static constexpr float kFourSigmaOfDifference2 = 2.0F * 4.0F * 4.0F;

  /// No time, or more ticks than can be counted: never. Less than a tick: one.
  static constexpr std::uint16_t ticks_in(Duration duration, Duration tick) {
    const std::int64_t ticks = duration / tick;
    if (!(duration > Duration{}) || ticks >= kNever) return kNever;
    return ticks > 0 ? static_cast<std::uint16_t>(ticks) : std::uint16_t{1};
  }
  static constexpr std::uint16_t clamp_ticks(std::uint16_t least, std::uint32_t ticks,
                                             std::uint16_t most) {
    if (ticks >= most) return most;
    return ticks < least ? least : static_cast<std::uint16_t>(ticks);
  }

  static constexpr bool is_near(const Rates& a, const Rates& b, float limit_rad2_s2) {
    for (std::size_t i = 0; i < Axes; ++i) {
      const float change = a[i] - b[i];
      if (change * change > limit_rad2_s2) return false;
    }
    return true;
  }

  constexpr void trust(const Rates& level) {
    state_.trusted_rad_s = level;
    state_.has_trusted = true;
  }
  [[nodiscard]] constexpr bool is_near_trusted(const Rates& rate, float limit_rad2_s2) const {
    return !state_.has_trusted || is_near(rate, state_.trusted_rad_s, limit_rad2_s2);
  }

  /// Mean rate of a window, and its noise.
  struct Window {
    Rates mean_rad_s{};
    float ticks = 0.0F;
    float white_of_tick = 0.0F;  ///< variance of the mean of a tick [rad2/s2]

    /// Square of six standard deviations of the difference from a level of so many ticks.
    [[nodiscard]] constexpr float noise_against(float level_ticks) const {
      return kSixSigma2 * white_of_tick * (1.0F / ticks + 1.0F / level_ticks);
    }
  };
  [[nodiscard]] constexpr Window window() const {
    Window window{.mean_rad_s = state_.window.mean_rad_s(),
                  .ticks = static_cast<float>(state_.window.ticks)};
    window.white_of_tick =
        white_rad2_s2_ * window.ticks / static_cast<float>(state_.window.samples);
    return window;
  }
  /// Ticks that the level is the mean of; where a stop begins, those of a window.
  [[nodiscard]] constexpr float level_ticks() const {
    const std::uint32_t ticks = (state_.stands ? state_.steady_ticks : 0U) + window_;
    return static_cast<float>(ticks < longest_memory_ ? ticks : longest_memory_);
  }
  /// Compares a window with the level, unless it is too loud to tell the least turn, shows no
  /// larger one, and may go on.
  [[gnu::noinline]] constexpr void judge(const Window& closed, const Rates* predicted) {
    const float noise = closed.noise_against(level_ticks());
    const float limit = std::max(least_turn_rad2_s2_, noise);
    if (!state_.stands) return begin_stop(closed.mean_rad_s, limit, predicted);
    if (!is_near(closed.mean_rad_s, state_.level_rad_s, limit)) {
      start_change(closed.mean_rad_s);
    } else if (noise <= least_turn_rad2_s2_ || state_.window.ticks >= longest_window_) {
      clear_window();
      track_level(closed);
    }
  }
  constexpr void begin_stop(const Rates& mean, float limit, const Rates* predicted) {
    restart_level(mean);
    state_.stands = true;
    if (predicted != nullptr) trust(*predicted);
    state_.turns = !is_near_trusted(mean, limit);
    state_.needed_ticks = longest_bend_;
  }

  constexpr void track_level(const Window& closed) {
    const float share = closed.ticks / (level_ticks() + closed.ticks);
    for (std::size_t i = 0; i < Axes; ++i) {
      state_.level_rad_s[i] += share * (closed.mean_rad_s[i] - state_.level_rad_s[i]);
    }
    age_level(static_cast<std::uint16_t>(closed.ticks));
    // A turn that just exceeds the limit must not end by chance: the way back is half as far.
    const float limit =
        std::max(0.25F * least_turn_rad2_s2_, kSixSigma2 * closed.white_of_tick / level_ticks());
    const bool is_back = state_.steady_ticks >= back_ && is_near_trusted(state_.level_rad_s, limit);
    if (is_back || state_.steady_ticks >= state_.needed_ticks) state_.turns = false;
  }

  constexpr void start_change(const Rates& mean) {
    if (!state_.turns) {
      state_.turns = true;
      trust(state_.level_rad_s);
      state_.needed_ticks = clamp_ticks(longest_bend_, 4U * state_.steady_ticks, longest_turn_);
    }
    restart_level(mean);
  }

  constexpr void restart_level(const Rates& rate) {
    state_.level_rad_s = rate;
    state_.steady_ticks = 0;
    clear_window();
  }
  constexpr void age_level(std::uint16_t ticks) {
    const auto room = static_cast<std::uint16_t>(kNever - 1U - state_.steady_ticks);
    state_.steady_ticks =
        static_cast<std::uint16_t>(state_.steady_ticks + (ticks < room ? ticks : room));
  }
  constexpr void clear_window() { state_.window = {}; }
  constexpr void count_down() {
    if (state_.bounced_ticks > 0) --state_.bounced_ticks;
  }

  Duration shortest_pulse_;
  std::uint16_t longest_turn_;
  std::uint16_t longest_bend_;
  std::uint16_t longest_straight_;
  std::uint8_t back_;
  std::uint8_t bounced_;
  std::uint8_t window_;
  std::uint8_t longest_window_;
  std::uint16_t longest_memory_;
  std::uint32_t fewest_samples_;  ///< samples that make a window worth judging
  float least_turn_rad2_s2_;      ///< smallest change reported as a turn, squared
  float white_rad2_s2_ = 0.0F;    ///< variance of a sample
  float noise_rad2_s2_ = 0.0F;
  State state_;
};

}  // namespace zerorate::core
