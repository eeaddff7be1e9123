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
/// The spread of three windows (WindowSpread) is compared with the level that this sensor has at
/// rest, axis by axis, and the sum of the ratios decides. The level is a low quantile of the
/// spread, followed by steps (Robbins and Monro 1951), so that half of a stop may be motion, and an
/// engine that starts raises it within bounded time. Where the samples come fast enough, the level
/// is at least a share of what the differences of neighbouring samples explain: vibration of an
/// engine counts as calm at once, because a tick averages it away.
///
/// A steady rate far from the prediction is a slow turn or a bias that has changed. It is calm
/// after it has lasted.
///
/// Cost of a sample: 9 floating-point operations; of a window: some 80 and 6 divisions.
template <std::size_t Axes>
class CalmJudge {
 public:
  using Rates = std::array<float, Axes>;
  using White = WhiteLevel<Axes>;

  struct State {
    Rates newest_rad_s{};         ///< newest sample
    Rates squares{};              ///< squared differences of neighbouring samples, summed
    Rates local_rad2_s2{};        ///< variance of a window's mean by these, over two windows or so
    Rates level_rad2_s2{};        ///< spread of three windows at rest
    TickWindow<Axes> window;      ///< window being filled
    WindowSpread<Axes> windows;   ///< windows before it
    float step = 0.0F;            ///< step of the levels, shrinking; 0: there are no levels yet
    std::uint32_t next_tick = 0;  ///< tick that continues the window
    std::uint16_t differences = 0;  ///< number of differences in `squares`
    std::uint8_t calm_windows = 0;  ///< calm windows in a row
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
           are_plausible_variances(state.level_rad2_s2) &&
           TickWindow<Axes>::is_possible(state.window) &&
           WindowSpread<Axes>::is_possible(state.windows) && state.step >= 0.0F &&
           state.step <= kFirstStep && are_bools(state.has_newest, state.is_calm) &&
           CalmShare::is_possible(state.share);
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
  /// @param predicted_rad_s the bias, or nullptr if none is known
  /// @param variance_rad2_s2 variance of that prediction
  /// @param white level of the node, which learns from the differences of neighbouring samples
  constexpr Calm judge(const TickMean<Axes>& tick, const Rates* predicted_rad_s,
                       float variance_rad2_s2, White& white) {
    if (tick.tick != state_.next_tick) restart_windows();
    state_.next_tick = tick.tick + 1U;
    state_.window.add(tick.rate_rad_s, tick.samples);
    if (state_.window.ticks == window_ticks_) close_window(white);
    if (!state_.is_calm) return Calm::moved;
    const float limit =
        kFarSigmas * kFarSigmas *
        (variance_rad2_s2 + white.shown_rad2_s2() / static_cast<float>(tick.samples));
    const bool is_doubted = predicted_rad_s != nullptr && state_.calm_windows < needed_windows_ &&
                            !are_near(tick.rate_rad_s, *predicted_rad_s, limit);
    return is_doubted ? Calm::far : Calm::calm;
  }

  /// True if the newest window is calm, or there are fewer than three.
  [[nodiscard]] constexpr bool is_calm() const { return state_.is_calm; }
  [[nodiscard]] constexpr const CalmShare& share() const { return state_.share; }

 private:
  static constexpr std::uint32_t kWindows = 3;
  /// Sum of the ratios over three axes that is motion: six standard deviations on one of them. Half
  /// and twice as much change the heading error by less than 3 % (docs/adr/0017).
  static constexpr float kMotion = 100.0F * static_cast<float>(Axes) / 3.0F;
  /// Least number of samples in a window whose differences show the noise of its mean.
  static constexpr float kFewestSamples = 4.0F;
  /// Share of the noise of the mean, as the differences explain it, that the level is at least.
  static constexpr float kLocalShare = 0.05F;
  static constexpr float kFirstStep = 0.5F;  ///< first step of the levels; shrinks by a tenth

  /// Quantile that the level is. Without an odometer most of the time is motion.
  [[nodiscard]] constexpr float quantile() const { return is_alone() ? 0.1F : 0.3F; }
  /// Step of the levels that remains.
  [[nodiscard]] constexpr float least_step() const { return is_alone() ? 0.03F : 0.1F; }
  [[nodiscard]] constexpr bool is_alone() const { return source_ == StandstillSource::gyro; }

  constexpr void close_window(White& white) {
    const auto samples = static_cast<float>(state_.window.samples);
    follow_local_noise(samples, white);
    Rates spread{};
    if (state_.windows.take(state_.window.mean_rad_s(), spread))
      judge_spread(spread, samples, white);
    if (state_.is_calm) white.rounding().observe(state_.squares, state_.differences);
    clear_window();
    if (!state_.is_calm) {
      state_.calm_windows = 0;
    } else if (state_.calm_windows < 0xFF) {
      ++state_.calm_windows;
    }
  }

  /// Takes what the samples of the window show of the variance of its mean.
  constexpr void follow_local_noise(float samples, White& white) {
    if (state_.differences == 0) return;
    if (samples >= kFewestSamples) white.observe_differences(state_.squares, state_.differences);
    for (std::size_t i = 0; i < Axes; ++i) {
      const float local =
          0.5F * state_.squares[i] / (static_cast<float>(state_.differences) * samples);
      float& kept = state_.local_rad2_s2[i];
      kept = state_.windows.known == 0 ? local : 0.5F * (kept + local);
    }
  }

  constexpr void judge_spread(const Rates& spread, float samples, const White& white) {
    if (state_.step == 0.0F) start_levels(spread);
    const float least = white.least_rad2_s2() / samples;
    state_.is_calm = is_calm_spread(spread, samples, least);
    follow_levels(spread, least);
    state_.share.count_window(state_.is_calm);
  }
  /// The spread of one axis alone may be small by chance, and then all that follows is motion: no
  /// level starts below the mean.
  constexpr void start_levels(const Rates& spread) {
    float mean = 0.0F;
    for (const float one : spread) mean += one * (1.0F / static_cast<float>(Axes));
    for (std::size_t i = 0; i < Axes; ++i) state_.level_rad2_s2[i] = std::max(spread[i], mean);
    state_.step = kFirstStep;
  }

  [[nodiscard]] constexpr bool is_calm_spread(const Rates& spread, float samples,
                                              float least) const {
    const float share = !is_alone() && samples >= kFewestSamples ? kLocalShare : 0.0F;
    float sum = 0.0F;
    for (std::size_t i = 0; i < Axes; ++i) {
      const float local = share * state_.local_rad2_s2[i];
      sum += spread[i] / std::max({state_.level_rad2_s2[i], local, least});
    }
    return sum <= kMotion;
  }

  constexpr void follow_levels(const Rates& spread, float least) {
    const float up = 1.0F + quantile() * state_.step;
    const float down = 1.0F - (1.0F - quantile()) * state_.step;
    for (std::size_t i = 0; i < Axes; ++i) {
      float& level = state_.level_rad2_s2[i];
      level = std::max(level * (spread[i] > level ? up : down), least);
    }
    constexpr float kShrink = 0.9F;
    state_.step = std::max(kShrink * state_.step, least_step());
  }

  constexpr void restart_windows() {
    state_.windows = {};
    state_.calm_windows = 0;
    state_.is_calm = true;
    clear_window();
  }
  constexpr void clear_window() {
    state_.window = {};
    state_.squares = {};
    state_.differences = 0;
  }

  StandstillSource source_;
  std::uint8_t window_ticks_;
  std::uint8_t needed_windows_;
  State state_{};
};

}  // namespace zerorate::core
