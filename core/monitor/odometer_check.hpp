/// @file
/// Contradictions between the odometer and the gyro, in fixed memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

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
  /// Longest time before a changed level is accepted as a bias that jumped, and is learnt. Longer
  /// than any turn that the odometer may miss. Default 2 min.
  Duration longest_turn = Duration::seconds(120);
  /// Time before a level is accepted that lies five standard deviations from the predicted bias.
  /// One that is twice as far takes 16 times as long, up to `longest_turn`; a nearer one takes as
  /// long. Default 5 s.
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
/// is refused for that; it must last a while, the longer the less likely it is by the prediction.
///
/// Two explanations are held meanwhile: the trusted level of before, and the level that is doubted.
/// A pulse decides nothing between them, so a level that is doubted at departure stays doubted in
/// the drive. The next stops decide: a second at the trusted level, or enough time at the doubted
/// one, over several stops if they agree. A level that was accepted may still have been a turn: a
/// return to the level of before is accepted at once.
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
    Rates level_rad_s{};              ///< recent level of the rate; while moving, the newest sample
    Rates trusted_rad_s{};            ///< level before the last change, if there was one
    Rates doubted_rad_s{};            ///< level that was doubted at departure
    Rates former_rad_s{};             ///< trusted level before one that was doubted was accepted
    TickWindow<Axes> window;          ///< window being filled
    std::uint16_t steady_ticks = 0;   ///< ticks since the level changed
    std::uint16_t needed_ticks = 0;   ///< ticks until a changed level is believed
    std::uint16_t doubted_ticks = 0;  ///< ticks at the doubted level, over several stops
    std::uint16_t doubted_needed_ticks = 0;  ///< ticks until it is believed
    std::uint8_t far_ticks = 0;      ///< newest ticks that were calm and far from the prediction
    std::uint8_t bounced_ticks = 0;  ///< ticks until the newest bounce is forgotten
    bool stands = false;             ///< the level is that of a stop
    bool turns = false;              ///< a rotation without pulses
    bool has_trusted = false;        ///< without a trusted level none counts as changed
    bool is_doubted = false;         ///< there is a doubted level
    bool has_former = false;         ///< there is a former level
    bool has_jumped = false;         ///< a level was accepted that no prediction explains

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
    return are_bools(state.stands, state.turns, state.has_trusted, state.is_doubted,
                     state.has_former, state.has_jumped) &&
           are_plausible(state.level_rad_s) && are_plausible(state.trusted_rad_s) &&
           are_plausible(state.doubted_rad_s) && are_plausible(state.former_rad_s) &&
           TickWindow<Axes>::is_possible(state.window) && state.steady_ticks < kNever &&
           state.doubted_ticks < kNever;
  }

  /// The variance of one sample is known better now.
  constexpr void set_white_noise(float white_variance_rad2_s2) {
    white_rad2_s2_ = white_variance_rad2_s2;
    noise_rad2_s2_ = kFourSigmaOfDifference2 * white_variance_rad2_s2;
  }

  /// A rotation without pulses: what is measured is no bias.
  [[nodiscard]] constexpr bool turns() const { return state_.turns; }
  /// A doubted level has lasted long enough to be learnt.
  [[nodiscard]] constexpr bool is_accepted() const {
    return state_.is_doubted && state_.doubted_ticks >= state_.doubted_needed_ticks;
  }
  /// Whether the level jumped since this was asked before.
  [[nodiscard]] constexpr bool take_jump() { return std::exchange(state_.has_jumped, false); }
  /// Anything at all contradicts the odometer, or the newest departure left two explanations.
  [[nodiscard]] constexpr bool disagrees() const {
    return state_.turns || state_.is_doubted || state_.bounced_ticks > 0 ||
           (!state_.stands && state_.steady_ticks >= longest_straight_);
  }

  /// @param since the pulse before; any other sign or none: out of order, ignored
  constexpr void pulse(Duration since) {
    if (state_.stands) depart();
    if (since > Duration{} && since < shortest_pulse_) state_.bounced_ticks = bounced_;
  }

  /// It is unknown since when the vehicle moves: the newest level was none of rest.
  constexpr void interrupt() {
    state_.turns = false;
    state_.far_ticks = 0;
    state_.stands = false;
    restart_level(state_.level_rad_s);
  }

  /// A tick begins while the vehicle moves.
  constexpr void on_driving_tick(const Rates& sample_rad_s) {
    count_down();
    if (state_.stands) depart();
    if (are_near(sample_rad_s, state_.level_rad_s, noise_rad2_s2_)) {
      age_level(1);
    } else {
      restart_level(sample_rad_s);
    }
    clear_window();
  }

  /// A tick of standstill is over.
  /// @param samples in it, at least one
  /// @param predicted_rad_s the bias, or nullptr if none is known
  /// @param variance_rad2_s2 variance of that prediction
  constexpr void on_standing_tick(const Rates& mean_rad_s, std::uint32_t samples,
                                  const Rates* predicted_rad_s, float variance_rad2_s2) {
    count_down();
    state_.window.add(mean_rad_s, samples);
    if (state_.window.ticks < window_ || state_.window.samples < fewest_samples_) return;
    judge(window(), {predicted_rad_s, variance_rad2_s2});
  }
  /// Takes the verdict of CalmJudge about that tick: whether it is far from the prediction.
  constexpr void take_verdict(bool is_far) {
    if (!is_far) {
      state_.far_ticks = 0;
    } else if (state_.far_ticks < 0xFF) {
      ++state_.far_ticks;
    }
  }

 private:
  static constexpr Duration kLongestWindow = Duration::seconds(2);  ///< window of a loud sensor
  static constexpr Duration kBackFor = Duration::seconds(1);        ///< then it is over
  static constexpr Duration kBouncedFor = Duration::seconds(2);     ///< it is reported for so long
  static constexpr Duration kMemory =
      Duration::seconds(15);  ///< memory of the level: a bias drifts
  static constexpr std::uint16_t kNever = 0xFFFF;
  /// Square of the part of the least turn by which the same level may differ from stop to stop.
  static constexpr float kSameLevel2 = 0.25F * 0.25F;
  // Six standard deviations of a difference are no noise, four may be, once in a while.
  static constexpr float kSixSigma2 = 6.0F * 6.0F;
  static constexpr float kFourSigmaOfDifference2 = 2.0F * 4.0F * 4.0F;

  /// No time, or more ticks than can be counted: never. Less than a tick: one.
  [[gnu::noinline]] static constexpr std::uint16_t ticks_in(Duration duration, Duration tick) {
    const std::int64_t ticks = duration / tick;
    if (!(duration > Duration{}) || ticks >= kNever) return kNever;
    return ticks > 0 ? static_cast<std::uint16_t>(ticks) : std::uint16_t{1};
  }
  /// The bias by the predictor, if there is one.
  struct Predicted {
    const Rates* rate_rad_s = nullptr;
    float variance_rad2_s2 = 0.0F;
  };

  /// The vehicle drives off. What was doubted stays doubted.
  constexpr void depart() {
    const bool is_far = state_.turns || state_.far_ticks > 0;
    if (!is_far && !state_.is_doubted) trust(state_.level_rad_s);
    if (is_far && state_.steady_ticks >= back_) doubt_level();
    interrupt();
  }

  constexpr void trust(const Rates& level) {
    state_.trusted_rad_s = level;
    state_.has_trusted = true;
  }
  [[nodiscard]] constexpr bool is_near_trusted(const Rates& rate, float limit_rad2_s2) const {
    return !state_.has_trusted || are_near(rate, state_.trusted_rad_s, limit_rad2_s2);
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
  [[gnu::noinline]] constexpr void judge(const Window& closed, const Predicted& predicted) {
    const float noise = closed.noise_against(level_ticks());
    const float limit = std::max(least_turn_rad2_s2_, noise);
    if (!state_.stands) return begin_stop(closed, noise, predicted);
    if (!are_near(closed.mean_rad_s, state_.level_rad_s, limit)) {
      start_change(closed, predicted);
    } else if (noise <= least_turn_rad2_s2_ || state_.window.ticks >= longest_window_) {
      clear_window();
      track_level(closed, predicted);
    }
  }
  constexpr void begin_stop(const Window& first, float noise, const Predicted& predicted) {
    restart_level(first.mean_rad_s);
    state_.stands = true;
    if (predicted.rate_rad_s != nullptr) trust(*predicted.rate_rad_s);
    state_.turns = !is_near_trusted(first.mean_rad_s, std::max(least_turn_rad2_s2_, noise));
    state_.needed_ticks = ticks_of_evidence(first, predicted);
    const float same = std::max(kSameLevel2 * least_turn_rad2_s2_, noise);
    if (!state_.is_doubted || !are_near(first.mean_rad_s, state_.doubted_rad_s, same)) return;
    state_.level_rad_s = state_.doubted_rad_s;
    state_.steady_ticks = state_.doubted_ticks;
    state_.needed_ticks = state_.doubted_needed_ticks;
  }
  /// Ticks until a level is believed: with the fourth power of its distance from the prediction, as
  /// the bias has heavier tails than a normal distribution, but no turn is as rare.
  [[nodiscard]] constexpr std::uint16_t ticks_of_evidence(const Window& level,
                                                          const Predicted& predicted) const {
    if (predicted.rate_rad_s == nullptr) return longest_bend_;
    float farthest = 0.0F;
    for (std::size_t i = 0; i < Axes; ++i) {
      const float change = level.mean_rad_s[i] - (*predicted.rate_rad_s)[i];
      farthest = std::max(farthest, change * change);
    }
    const float variance = predicted.variance_rad2_s2 + level.white_of_tick / level.ticks;
    const float surprise = farthest / (kFarSigmas * kFarSigmas * variance);
    const float ticks = static_cast<float>(longest_bend_) * surprise * surprise;
    if (!(ticks < static_cast<float>(longest_turn_))) return longest_turn_;
    return std::max(longest_bend_, static_cast<std::uint16_t>(ticks));
  }

  constexpr void track_level(const Window& closed, const Predicted& predicted) {
    const float share = closed.ticks / (level_ticks() + closed.ticks);
    for (std::size_t i = 0; i < Axes; ++i) {
      state_.level_rad_s[i] += share * (closed.mean_rad_s[i] - state_.level_rad_s[i]);
    }
    age_level(static_cast<std::uint16_t>(closed.ticks));
    // A turn that just exceeds the limit must not end by chance: the way back is half as far.
    const float limit =
        std::max(0.25F * least_turn_rad2_s2_, kSixSigma2 * closed.white_of_tick / level_ticks());
    if (state_.turns || state_.is_doubted) decide(predicted, limit);
  }
  /// Whether one of the two explanations is to be believed now.
  constexpr void decide(const Predicted& predicted, float limit_rad2_s2) {
    const auto is_at = [&](const Rates& explained) {
      return state_.steady_ticks >= back_ && are_near(state_.level_rad_s, explained, limit_rad2_s2);
    };
    const bool is_back = state_.has_trusted && is_at(state_.trusted_rad_s);
    const bool is_former = state_.has_former && is_at(state_.former_rad_s);
    const bool is_predicted = predicted.rate_rad_s == nullptr || is_at(*predicted.rate_rad_s);
    if (is_back) state_.turns = false;
    if (is_former) state_.needed_ticks = back_;
    if (is_predicted && !state_.turns && state_.far_ticks == 0) state_.is_doubted = false;
    if ((state_.turns || state_.is_doubted) && state_.steady_ticks >= state_.needed_ticks) {
      accept_level();
    }
  }
  /// The doubted level is the bias. It stays in doubt until the predictor has learnt it: the stop
  /// may be too short for that.
  constexpr void accept_level() {
    if (!is_accepted()) {
      state_.former_rad_s = state_.trusted_rad_s;
      state_.has_former = state_.has_trusted;
      state_.has_jumped = true;
    }
    state_.turns = false;
    doubt_level();
  }
  constexpr void doubt_level() {
    state_.is_doubted = true;
    state_.doubted_rad_s = state_.level_rad_s;
    state_.doubted_ticks = state_.steady_ticks;
    state_.doubted_needed_ticks = state_.needed_ticks;
  }

  constexpr void start_change(const Window& changed, const Predicted& predicted) {
    if (!state_.turns) {
      state_.turns = true;
      state_.doubted_ticks = 0;
      trust(state_.level_rad_s);
      // Four times the age of the level before: one that was new itself is soon given up.
      const std::uint32_t four_times = 4U * std::uint32_t{state_.steady_ticks};
      const auto by_age =
          static_cast<std::uint16_t>(std::min(four_times, std::uint32_t{longest_turn_}));
      state_.needed_ticks = std::max(by_age, ticks_of_evidence(changed, predicted));
    }
    restart_level(changed.mean_rad_s);
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
