/// @file
/// Judgement of the calm inside a stop, against the noise that this sensor itself has shown.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"
#include "core/samples/tick_average.hpp"
#include "core/samples/tick_window.hpp"
#include "core/samples/white_level.hpp"
#include "core/standstill/calm_share.hpp"
#include "core/standstill/force_witness.hpp"
#include "core/standstill/rest_spread.hpp"
#include "core/standstill/standstill.hpp"

namespace zerorate::core {

/// Outcome of a judged tick.
enum class Calm : std::uint8_t {
  calm,   ///< may be learnt from, as far as is known by now
  moved,  ///< motion within the newest windows: neither this tick nor the ticks before it
  far,    ///< steady, but at another rate than predicted, and not for long yet: not this tick
};

/// Separates the calm of a stop from motion that an odometer does not report (docs/adr/0017).
///
/// The spread of three windows decides (RestSpread): that of the rates, and that of the specific
/// force where it is measured. Where the samples come fast enough, a spread counts as rest up to a
/// share of what the differences of neighbouring samples explain: vibration of an engine is calm at
/// once, because a tick averages it away.
///
/// A steady rate far from the prediction is a slow turn or a bias that has changed. It is calm
/// after it has lasted.
///
/// Cost of a sample: 9 floating-point operations; of a window: some 80 and 6 divisions.
/// @tparam Witness ForceWitness or NoWitness
template <std::size_t Axes, class Witness = NoWitness>
class CalmJudge {
 public:
  using Rates = std::array<float, Axes>;
  using White = WhiteLevel<Axes>;
  using Force = typename Witness::Force;

  struct State {
    Rates newest_rad_s{};     ///< newest sample
    Rates squares{};          ///< squared differences of neighbouring samples, summed
    Rates local_rad2_s2{};    ///< variance of a window's mean by these, over two windows or so
    RestSpread<Axes> spread;  ///< spread of the rates
    [[no_unique_address]] Witness witness;  ///< spread of the specific force
    std::uint32_t next_tick = 0;            ///< tick that continues the window
    std::uint16_t differences = 0;          ///< number of differences in `squares`
    std::uint8_t calm_windows = 0;          ///< calm windows in a row
    bool has_newest = false;
    bool is_calm = true;  ///< newest window is calm, or there are fewer than three
    CalmShare share;

    constexpr bool operator==(const State&) const = default;
  };

  /// @param longest_bend a steady rate far from the prediction counts as a turn for so long
  constexpr CalmJudge(StandstillSource source, Duration longest_bend, Duration tick)
      : source_(source),
        window_ticks_(window_ticks(tick)),
        needed_windows_(ticks_in_u8(longest_bend, tick * window_ticks_)) {}

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// True if a restored state is valid.
  [[nodiscard]] static bool is_possible(const State& state) {
    return are_plausible(state.newest_rad_s) && are_plausible_variances(state.squares) &&
           are_plausible_variances(state.local_rad2_s2) &&
           RestSpread<Axes>::is_possible(state.spread) && Witness::is_possible(state.witness) &&
           are_bools(state.has_newest, state.is_calm) && CalmShare::is_possible(state.share);
  }

  /// Ticks until the last verdict about a tick: the two windows that follow its own.
  [[nodiscard]] static constexpr std::int64_t ticks_of_verdict(Duration tick) {
    return std::int64_t{kWindows - 1U} * window_ticks(tick);
  }
  /// Ticks of three windows: the reach of a verdict.
  [[nodiscard]] constexpr std::uint32_t reach_ticks() const { return kWindows * window_ticks_; }

  /// The vehicle moves, by the odometer.
  constexpr void end_stop() {
    state_.share.end_stop();
    state_.has_newest = false;
    restart_windows();
  }

  /// The next sample of the tick being filled.
  constexpr void add(const Rates& rate_rad_s) {
    if (state_.has_newest && state_.differences < 0xFFFF) {
      for (std::size_t i = 0; i < Axes; ++i) {
        const float change = rate_rad_s[i] - state_.newest_rad_s[i];
        state_.squares[i] += change * change;
      }
      ++state_.differences;
    }
    state_.newest_rad_s = rate_rad_s;
    state_.has_newest = true;
  }

  /// A tick is over.
  /// @param force specific force of the tick
  /// @param predicted_rad_s the bias, or nullptr if none is known
  /// @param variance_rad2_s2 variance of that prediction
  /// @param white level of the node, which learns from the differences of neighbouring samples
  constexpr Calm judge(const TickMean<Axes>& tick, const Force& force, const Rates* predicted_rad_s,
                       float variance_rad2_s2, White& white) {
    if (tick.tick != state_.next_tick) restart_windows();
    state_.next_tick = tick.tick + 1U;
    state_.spread.add(tick.rate_rad_s, tick.samples);
    state_.witness.add(force);
    const bool closes = state_.spread.window().ticks == window_ticks_;
    if (closes) close_window(white);
    const Calm calm = verdict(tick, predicted_rad_s, variance_rad2_s2, white);
    if (closes) {
      // At the rate of a turn the samples lie otherwise within a step.
      if (calm == Calm::calm) white.rounding().observe(state_.squares, state_.differences);
      clear_differences();
    }
    return calm;
  }

  /// True if the newest window is calm, or there are fewer than three.
  [[nodiscard]] constexpr bool is_calm() const { return state_.is_calm; }
  [[nodiscard]] constexpr const CalmShare& share() const { return state_.share; }

 private:
  static constexpr std::uint32_t kWindows = 3;
  /// Least number of samples in a window whose differences show the noise of its mean.
  static constexpr float kFewestSamples = 4.0F;
  /// Share of the noise of the mean, as the differences explain it, that the level is at least.
  static constexpr float kLocalShare = 0.05F;

  [[nodiscard]] constexpr bool is_alone() const { return source_ == StandstillSource::gyro; }

  [[nodiscard]] constexpr Calm verdict(const TickMean<Axes>& tick, const Rates* predicted_rad_s,
                                       float variance_rad2_s2, const White& white) const {
    if (!state_.is_calm) return Calm::moved;
    const float limit =
        kFarSigmas * kFarSigmas *
        (variance_rad2_s2 + white.shown_rad2_s2() / static_cast<float>(tick.samples));
    const bool is_doubted = predicted_rad_s != nullptr && state_.calm_windows < needed_windows_ &&
                            !are_near(tick.rate_rad_s, *predicted_rad_s, limit);
    return is_doubted ? Calm::far : Calm::calm;
  }

  constexpr void close_window(White& white) {
    const auto samples = static_cast<float>(state_.spread.window().samples);
    follow_local_noise(samples, white);
    const auto of_rate = state_.spread.close(is_alone(), white.least_rad2_s2() / samples,
                                             tolerated_rad2_s2(samples));
    judge_spreads(of_rate, state_.witness.close(is_alone()));
    if (!state_.is_calm) {
      state_.calm_windows = 0;
    } else if (state_.calm_windows < 0xFF) {
      ++state_.calm_windows;
    }
  }
  /// Motion that either shows is motion.
  constexpr void judge_spreads(RestVerdict of_rate, RestVerdict of_force) {
    if (of_rate == RestVerdict::unknown) return;
    state_.is_calm = of_rate == RestVerdict::rest && of_force != RestVerdict::motion;
    state_.share.count_window(state_.is_calm);
  }

  /// Takes what the samples of the window show of the variance of its mean.
  constexpr void follow_local_noise(float samples, White& white) {
    if (state_.differences == 0) return;
    if (samples >= kFewestSamples) white.observe_differences(state_.squares, state_.differences);
    for (std::size_t i = 0; i < Axes; ++i) {
      const float local =
          0.5F * state_.squares[i] / (static_cast<float>(state_.differences) * samples);
      float& kept = state_.local_rad2_s2[i];
      kept = state_.spread.is_first_window() ? local : 0.5F * (kept + local);
    }
  }

  /// Level that the noise of the samples explains.
  [[nodiscard]] constexpr Rates tolerated_rad2_s2(float samples) const {
    Rates tolerated{};
    if (is_alone() || samples < kFewestSamples) return tolerated;
    for (std::size_t i = 0; i < Axes; ++i) tolerated[i] = kLocalShare * state_.local_rad2_s2[i];
    return tolerated;
  }

  constexpr void restart_windows() {
    state_.spread.restart();
    state_.witness.restart();
    state_.calm_windows = 0;
    state_.is_calm = true;
    clear_differences();
  }
  constexpr void clear_differences() {
    state_.squares = {};
    state_.differences = 0;
  }

  StandstillSource source_;
  std::uint8_t window_ticks_;
  std::uint8_t needed_windows_;
  State state_{};
};

}  // namespace zerorate::core
