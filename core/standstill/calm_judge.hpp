/// @file
/// Judgement of the calm inside a stop, against the noise that this sensor itself has shown.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"
#include "core/samples/tick_average.hpp"
#include "core/standstill/standstill.hpp"

namespace zerorate::core {

/// Outcome of a judged tick.
enum class Calm : std::uint8_t {
  calm,   ///< may be learnt from, as far as is known by now
  moved,  ///< motion within the newest windows: neither this tick nor the ticks before it
  far,    ///< steady, but at another rate than predicted, and not for long yet: not this tick
};

/// Tells the calm of a stop from motion that an odometer does not report (docs/adr/0017).
///
/// Ticks are averaged over windows of half a second. The spread of three consecutive windows,
///
///     T = (a^2 + a b + b^2) / 3,   a, b: their two differences,
///
/// is their sample variance, axis by axis: of white noise it is the variance of a window's mean, of
/// a rotation that begins or ends it is far more. T is compared with the level L that this sensor
/// has at rest, and the three axes are judged by the sum of T / L. The level is a low quantile of
/// T, followed by steps (Robbins and Monro 1951), so that half of a stop may be motion, and an
/// engine that starts raises it within bounded time. Where the samples come fast enough, the level
/// is at least a share of what the differences of neighbouring samples explain: vibration of an
/// engine counts as calm at once, because a tick averages it away.
///
/// A steady rate far from the prediction is a slow turn or a bias that has changed. It is calm
/// after it has lasted.
///
/// Cost of a sample: 9 floating-point operations; of a window: some 80 and 6 divisions.
class CalmJudge {
 public:
  static constexpr std::size_t kAxes = 3;
  static constexpr std::uint8_t kNoPercent = 0xFF;
  using Rates = std::array<float, kAxes>;

  /// Counts of judged windows of a stop.
  struct Share {
    std::uint16_t calm = 0;
    std::uint16_t all = 0;

    constexpr bool operator==(const Share&) const = default;
  };

  struct State {
    Rates newest_rad_s{};   ///< the newest sample
    Rates squares{};        ///< of the differences of neighbouring samples in this window, summed
    Rates local_rad2_s2{};  ///< variance of a window's mean by these, over two windows or so
    Rates sum_rad_s{};      ///< of the ticks of the window being filled
    std::array<Rates, 2> windows_rad_s{};  ///< the two newest means
    Rates level_rad2_s2{};                 ///< of the spread of three windows at rest
    float step = 0.0F;                     ///< of the levels, shrinking; 0: there are none yet
    float white_rad2_s2 = 0.0F;            ///< variance of a sample by the spread of calm windows
    float local_white_rad2_s2 = 0.0F;      ///< by neighbouring samples, over eight windows or so
    std::uint32_t next_tick = 0;           ///< that continues the window
    std::uint32_t samples = 0;             ///< in the window
    std::uint16_t differences = 0;         ///< in `squares`
    std::uint16_t local_differences = 0;   ///< that `local_white_rad2_s2` is the mean of
    Share share;                           ///< of this stop, or the one before
    std::uint8_t window_ticks = 0;         ///< summed so far
    std::uint8_t known_windows = 0;        ///< in `windows_rad_s`
    std::uint8_t calm_windows = 0;         ///< one after the other
    std::uint8_t spreads = 0;              ///< that `white_rad2_s2` is the mean of
    std::uint8_t stops_with_motion = 0;    ///< counted up by those, down by stops without
    bool has_newest = false;
    bool stop_is_over = false;
    bool is_calm = true;  ///< the newest window, or there are fewer than three

    constexpr bool operator==(const State&) const = default;
  };

  /// @param longest_bend for which a steady rate far from the prediction is not believed
  /// @param white_variance_rad2_s2 of one sample by the model, until there are windows
  constexpr CalmJudge(StandstillSource source, Duration longest_bend, Duration tick,
                      float white_variance_rad2_s2)
      : source_(source),
        window_ticks_(ticks_of_window(tick)),
        needed_windows_(clamped_to_u8(longest_bend / (tick * window_ticks_))),
        model_white_rad2_s2_(white_variance_rad2_s2) {
    state_.white_rad2_s2 = state_.local_white_rad2_s2 = white_variance_rad2_s2;
  }

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// Whether memory from outside may be such a state.
  [[nodiscard]] static bool is_possible(const State& state) {
    const bool are_numbers =
        are_plausible(state.newest_rad_s) && are_plausible(state.sum_rad_s) &&
        are_plausible(state.windows_rad_s[0]) && are_plausible(state.windows_rad_s[1]) &&
        are_plausible_variances(state.squares) && are_plausible_variances(state.local_rad2_s2) &&
        are_plausible_variances(state.level_rad2_s2) &&
        is_plausible_variance(state.white_rad2_s2) &&
        is_plausible_variance(state.local_white_rad2_s2);
    const bool are_counts = state.step >= 0.0F && state.step <= kFirstStep &&
                            state.share.calm <= state.share.all &&
                            state.share.all <= kShareWindows && state.known_windows <= 2 &&
                            state.spreads <= kSpreads && state.stops_with_motion <= kMostStops;
    return are_numbers && are_counts &&
           are_bools(state.has_newest, state.stop_is_over, state.is_calm);
  }

  /// Ticks until the last verdict about a tick: the two windows that follow its own.
  [[nodiscard]] static constexpr std::int64_t ticks_of_verdict(Duration tick) {
    return std::int64_t{kWindows - 1U} * ticks_of_window(tick);
  }
  /// Ticks of three windows: what a verdict is about.
  [[nodiscard]] constexpr std::uint32_t reach_ticks() const { return kWindows * window_ticks_; }

  /// The vehicle moves, by the odometer.
  constexpr void end_stop() {
    if (!state_.stop_is_over && state_.share.all > 0) count_stop();
    state_.stop_is_over = true;
    restart();
  }

  /// The next sample of the tick being filled.
  constexpr void add(const Rates& rate_rad_s) {
    if (state_.has_newest && state_.differences < 0xFFFF) {
      for (std::size_t i = 0; i < kAxes; ++i) {
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
  /// @param variance_rad2_s2 of that prediction
  constexpr Calm judge(const TickMean<kAxes>& tick, const Rates* predicted_rad_s,
                       float variance_rad2_s2) {
    if (tick.tick != state_.next_tick) restart_windows();
    state_.next_tick = tick.tick + 1U;
    for (std::size_t i = 0; i < kAxes; ++i) state_.sum_rad_s[i] += tick.rate_rad_s[i];
    state_.samples += tick.samples;
    if (++state_.window_ticks == window_ticks_) close_window();
    if (!state_.is_calm) return Calm::moved;
    const bool is_doubted = predicted_rad_s != nullptr && state_.calm_windows < needed_windows_ &&
                            is_far(tick, *predicted_rad_s, variance_rad2_s2);
    return is_doubted ? Calm::far : Calm::calm;
  }

  /// Variance of the white noise of a sample, as the means over half a second show it: by the
  /// model, until three windows were calm.
  [[nodiscard]] constexpr float white_variance_rad2_s2() const { return state_.white_rad2_s2; }
  [[nodiscard]] constexpr bool has_seen_white_noise() const { return state_.spreads > 0; }
  /// The mean is of as many spreads as it ever is.
  [[nodiscard]] constexpr bool knows_white_noise() const { return state_.spreads == kSpreads; }
  /// Variance of a sample that neither a swaying vehicle nor its engine explains: the lesser of
  /// what windows and what neighbouring samples show, never less than by the model. It is enlarged
  /// so that six standard deviations are as rare as if it were known.
  [[nodiscard]] constexpr float sure_white_variance_rad2_s2() const {
    const float shown =
        std::min(sure(state_.white_rad2_s2, kDegreesOfSpread * static_cast<float>(state_.spreads)),
                 sure(state_.local_white_rad2_s2,
                      kDegreesOfDifference * static_cast<float>(state_.local_differences)));
    return shown < kUnknown ? std::max(shown, model_white_rad2_s2_)
                            : sure(model_white_rad2_s2_, kFewestDegrees);
  }
  /// Whether the newest window is calm; true before there are three.
  [[nodiscard]] constexpr bool is_calm() const { return state_.is_calm; }
  /// Share of the newest stop that was calm, rounded down; of a long stop that of its last two
  /// minutes or so. kNoPercent before anything was judged.
  [[nodiscard]] constexpr std::uint8_t percent() const {
    const Share& share = state_.share;
    if (share.all == 0) return kNoPercent;
    return static_cast<std::uint8_t>(std::uint32_t{share.calm} * 100U / share.all);
  }
  /// Motion was found in most of the newest stops: the odometer says nothing of slow rolling.
  [[nodiscard]] constexpr bool has_dead_band() const {
    return state_.stops_with_motion >= kStopsOfDeadBand;
  }

 private:
  static constexpr Duration kWindow = Duration::milliseconds(500);
  static constexpr std::uint32_t kWindows = 3;
  /// Sum of T / L over the axes that is motion: six standard deviations on one axis. Half and twice
  /// as much change the heading error by less than 3 % (docs/adr/0017).
  static constexpr float kMotion = 100.0F;
  /// A prediction that is missed by more standard deviations is doubted.
  static constexpr float kFar = 5.0F;
  /// Samples in a window from which their differences tell the noise of its mean.
  static constexpr float kFewestSamples = 4.0F;
  /// Share of the noise of the mean, as the differences explain it, that the level is at least.
  static constexpr float kLocalShare = 0.05F;
  /// Share of the model's white variance that noise never falls below, so that a sensor that
  /// repeats one reading is not taken for a perfect one.
  static constexpr float kSmallestWhite = 1e-4F;
  static constexpr float kLargestRise = 8.0F;   ///< of the white variance, by one spread
  static constexpr std::uint8_t kSpreads = 64;  ///< memory of the white variance, half a minute
  static constexpr float kFirstStep = 0.5F;     ///< of the levels; it shrinks by a tenth a window
  static constexpr std::uint32_t kLocalWindows = 8;  ///< memory of the differences' variance
  // Degrees of freedom, of three axes: 1 and 2/3 each, because neighbours share a window or sample.
  static constexpr float kDegreesOfSpread = 3.0F;
  static constexpr float kDegreesOfDifference = 2.0F;
  static constexpr float kFewestDegrees = 6.0F;  ///< that say anything; those of a model
  static constexpr float kUnknown = std::numeric_limits<float>::infinity();
  static constexpr std::uint16_t kShareWindows = 256;
  static constexpr std::uint8_t kStopsOfDeadBand = 3;
  static constexpr std::uint8_t kMostStops = 8;

  static constexpr std::uint8_t clamped_to_u8(std::int64_t count) {
    return static_cast<std::uint8_t>(std::clamp(count, std::int64_t{1}, std::int64_t{0xFF}));
  }

  static constexpr std::uint8_t ticks_of_window(Duration tick) {
    return clamped_to_u8(kWindow / tick);
  }

  /// The quantile that the level is, and the step that remains. Without an odometer most of the
  /// time is motion.
  [[nodiscard]] constexpr float quantile() const { return is_alone() ? 0.1F : 0.3F; }
  [[nodiscard]] constexpr float least_step() const { return is_alone() ? 0.03F : 0.1F; }
  [[nodiscard]] constexpr bool is_alone() const { return source_ == StandstillSource::gyro; }

  constexpr void close_window() {
    const auto samples = static_cast<float>(state_.samples);
    const Rates mean = take_window(samples);
    if (state_.known_windows == 2) {
      judge_spread(spread_of(mean), samples);
    } else {
      ++state_.known_windows;
    }
    state_.windows_rad_s[1] = state_.windows_rad_s[0];
    state_.windows_rad_s[0] = mean;
    if (!state_.is_calm) {
      state_.calm_windows = 0;
    } else if (state_.calm_windows < 0xFF) {
      ++state_.calm_windows;
    }
  }

  /// Mean of the window, which is then empty; keeps what its samples say of the mean's variance.
  constexpr Rates take_window(float samples) {
    Rates mean{};
    if (samples >= kFewestSamples && state_.differences > 0) learn_local_white();
    for (std::size_t i = 0; i < kAxes; ++i) {
      mean[i] = state_.sum_rad_s[i] / static_cast<float>(window_ticks_);
      if (state_.differences > 0) {
        const float local =
            0.5F * state_.squares[i] / (static_cast<float>(state_.differences) * samples);
        state_.local_rad2_s2[i] =
            state_.known_windows == 0 ? local : 0.5F * (state_.local_rad2_s2[i] + local);
      }
    }
    clear_window();
    return mean;
  }

  constexpr void learn_local_white() {
    const std::uint32_t newest = state_.differences;
    const std::uint32_t all = state_.local_differences + newest;
    const std::uint32_t kept = all < kLocalWindows * newest ? all : kLocalWindows * newest;
    const float sum = state_.squares[0] + state_.squares[1] + state_.squares[2];
    const float excess =
        (1.0F / 6.0F) * sum - state_.local_white_rad2_s2 * static_cast<float>(newest);
    state_.local_white_rad2_s2 += excess / static_cast<float>(kept);
    state_.local_differences = static_cast<std::uint16_t>(kept < 0xFFFF ? kept : 0xFFFF);
  }

  [[gnu::noinline]] static constexpr float sure(float variance, float degrees_of_freedom) {
    constexpr float kSixSigma2 = 36.0F;
    if (degrees_of_freedom < kFewestDegrees) return kUnknown;
    return variance * student_factor(kSixSigma2, degrees_of_freedom);
  }

  [[nodiscard]] constexpr Rates spread_of(const Rates& mean) const {
    Rates spread{};
    for (std::size_t i = 0; i < kAxes; ++i) {
      const float a = mean[i] - state_.windows_rad_s[0][i];
      const float b = state_.windows_rad_s[0][i] - state_.windows_rad_s[1][i];
      spread[i] = (a * a + a * b + b * b) * (1.0F / 3.0F);
    }
    return spread;
  }

  constexpr void judge_spread(const Rates& spread, float samples) {
    if (state_.step == 0.0F) {
      // The spread of one axis alone may be small by chance, and then all that follows is motion.
      const float mean = (spread[0] + spread[1] + spread[2]) * (1.0F / 3.0F);
      for (std::size_t i = 0; i < kAxes; ++i) {
        state_.level_rad2_s2[i] = std::max(spread[i], mean);
      }
      state_.step = kFirstStep;
    }
    const float least = kSmallestWhite * model_white_rad2_s2_ / samples;
    state_.is_calm = is_calm_spread(spread, samples, least);
    follow_levels(spread, least);
    if (state_.is_calm) learn_white(spread, samples);
    count_window();
  }

  [[nodiscard]] constexpr bool is_calm_spread(const Rates& spread, float samples,
                                              float least) const {
    const float share = !is_alone() && samples >= kFewestSamples ? kLocalShare : 0.0F;
    float sum = 0.0F;
    for (std::size_t i = 0; i < kAxes; ++i) {
      const float local = share * state_.local_rad2_s2[i];
      sum += spread[i] / std::max({state_.level_rad2_s2[i], local, least});
    }
    return sum <= kMotion;
  }

  constexpr void follow_levels(const Rates& spread, float least) {
    const float up = 1.0F + quantile() * state_.step;
    const float down = 1.0F - (1.0F - quantile()) * state_.step;
    for (std::size_t i = 0; i < kAxes; ++i) {
      float& level = state_.level_rad2_s2[i];
      level = std::max(level * (spread[i] > level ? up : down), least);
    }
    constexpr float kShrink = 0.9F;
    state_.step = std::max(kShrink * state_.step, least_step());
  }

  constexpr void learn_white(const Rates& spread, float samples) {
    float sum = 0.0F;
    float axes = 0.0F;
    for (const float one : spread) {
      if (one > 0.0F) {  // an axis without any noise is not there
        sum += one;
        ++axes;
      }
    }
    const float mean = axes > 0.0F ? sum / axes * samples : 0.0F;
    float& white = state_.white_rad2_s2;
    const float bounded = state_.spreads > 0 ? std::min(mean, kLargestRise * white) : mean;
    if (state_.spreads < kSpreads) ++state_.spreads;
    white += (bounded - white) / static_cast<float>(state_.spreads);
    white = std::max(white, kSmallestWhite * model_white_rad2_s2_);
  }

  [[nodiscard]] constexpr bool is_far(const TickMean<kAxes>& tick, const Rates& predicted_rad_s,
                                      float variance_rad2_s2) const {
    const float limit =
        kFar * kFar * (variance_rad2_s2 + state_.white_rad2_s2 / static_cast<float>(tick.samples));
    for (std::size_t i = 0; i < kAxes; ++i) {
      const float change = tick.rate_rad_s[i] - predicted_rad_s[i];
      if (change * change > limit) return true;
    }
    return false;
  }

  constexpr void count_window() {
    Share& share = state_.share;
    if (state_.stop_is_over) share = {};
    state_.stop_is_over = false;
    if (share.all == kShareWindows) {
      share = {.calm = static_cast<std::uint16_t>(share.calm / 2U),
               .all = static_cast<std::uint16_t>(share.all / 2U)};
    }
    ++share.all;
    if (state_.is_calm) ++share.calm;
  }
  constexpr void count_stop() {
    const bool has_motion = state_.share.calm < state_.share.all;
    std::uint8_t& stops = state_.stops_with_motion;
    if (has_motion && stops < kMostStops) ++stops;
    if (!has_motion && stops > 0) --stops;
  }

  constexpr void restart() {
    state_.has_newest = false;
    restart_windows();
  }
  constexpr void restart_windows() {
    state_.known_windows = 0;
    state_.calm_windows = 0;
    state_.is_calm = true;
    clear_window();
  }
  constexpr void clear_window() {
    state_.sum_rad_s = {};
    state_.samples = 0;
    state_.window_ticks = 0;
    state_.squares = {};
    state_.differences = 0;
  }

  StandstillSource source_;
  std::uint8_t window_ticks_;
  std::uint8_t needed_windows_;
  float model_white_rad2_s2_;
  State state_{};
};

}  // namespace zerorate::core
