/// @file
/// Strength of the white noise of a sensor's samples.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"
#include "core/samples/noise_level_track.hpp"
#include "core/samples/rounding_watch.hpp"
#include "core/samples/sample_model.hpp"
#include "core/samples/tick_average.hpp"
#include "core/samples/tick_window.hpp"

namespace zerorate::core {

/// Origin of a white level.
enum class WhiteKnowledge : std::uint8_t {
  model,  ///< the model's: no window of a stop has been learnt from
  seen,   ///< measured, and still becoming more exact
  known,  ///< measured with full memory
};

/// Variance of the white noise of one sample, the only owner of that figure in a node.
///
/// Three calm windows of ticks give a spread (WindowSpread), whose mean over the last half minute
/// is the variance. A model of single samples (SampleModel::needs_screen) states how the strength
/// wanders; then NoiseLevelTrack follows it instead, and nothing is measured here.
///
/// What a filter has learnt is relative to a reference, the level at which it was learnt. While the
/// level becomes more exact, the reference follows it (rebase()); afterwards a level that differs
/// from it by more than a factor of two is a change of the sensor (change()).
///
/// Cost of a tick: 10 floating-point operations; of a window: some 40 and 3 divisions.
template <std::size_t Axes>
class WhiteLevel {
 public:
  using Rates = std::array<float, Axes>;

  /// Figures that are measured here.
  struct Measured {
    TickWindow<Axes> window;              ///< being filled with ticks that were learnt from
    WindowSpread<Axes> windows;           ///< the windows before it
    float variance_rad2_s2 = 0.0F;        ///< variance of a sample by the spread of windows
    float local_rad2_s2 = 0.0F;           ///< variance of a sample by differences of neighbours
    float reference = 0.0F;               ///< level that learnt figures rest on; 0: none
    std::uint32_t next_tick = 0;          ///< tick that continues the window
    std::uint16_t local_differences = 0;  ///< differences that `local_rad2_s2` is the mean of
    std::uint8_t spreads = 0;             ///< spreads that `variance_rad2_s2` is the mean of
    bool reference_is_known = false;      ///< the reference does not follow any more

    constexpr bool operator==(const Measured&) const = default;
  };
  struct State : Measured {
    NoiseLevelTrack::State track;  ///< only under a model of single samples
    typename RoundingWatch<Axes>::State rounding;

    constexpr bool operator==(const State&) const = default;
  };

  /// @param model_variance_rad2_s2 white variance of one sample by the model; positive
  /// @param learns false: the model's variance holds whatever is measured
  constexpr WhiteLevel(float model_variance_rad2_s2, const SampleModel& samples, Duration tick,
                       bool learns, const Rounding& rounding = {})
      : model_rad2_s2_(model_variance_rad2_s2),
        window_ticks_(window_ticks(tick)),
        learns_(learns && !samples.needs_screen()),
        track_(samples.level),
        rounding_(rounding, model_variance_rad2_s2) {
    state_.variance_rad2_s2 = state_.local_rad2_s2 = model_variance_rad2_s2;
  }

  [[nodiscard]] constexpr State state() const {
    return {state_, track_.state(), rounding_.state()};
  }
  constexpr void restore(const State& state) {
    state_ = state;
    track_.restore(state.track);
    rounding_.restore(state.rounding);
  }
  /// True if a restored state is valid.
  [[nodiscard]] static bool is_possible(const State& state) {
    return TickWindow<Axes>::is_possible(state.window) &&
           WindowSpread<Axes>::is_possible(state.windows) &&
           RoundingWatch<Axes>::is_possible(state.rounding) &&
           is_plausible_variance(state.variance_rad2_s2) &&
           is_plausible_variance(state.local_rad2_s2) && is_plausible_variance(state.reference) &&
           state.spreads <= kSpreads && is_bool(state.reference_is_known) &&
           state.track.level > 0.0F && is_plausible(state.track.level) &&
           is_plausible_variance(state.track.variance);
  }

  /// A tick was learnt from: the next one of a stop, or the first after a gap.
  constexpr void observe(const TickMean<Axes>& tick) {
    if (tick.tick != state_.next_tick) {
      state_.window = {};
      state_.windows = {};
    }
    state_.next_tick = tick.tick + 1U;
    state_.window.add(tick.rate_rad_s, tick.samples);
    if (state_.window.ticks < window_ticks_) return;
    Rates spread{};
    const auto samples = static_cast<float>(state_.window.samples);
    if (state_.windows.take(state_.window.mean_rad_s(), spread)) observe_spread(spread, samples);
    state_.window = {};
  }

  /// Differences of neighbouring samples in a window.
  /// @param squares sum of their squares on each axis
  constexpr void observe_differences(const Rates& squares, std::uint32_t differences) {
    const std::uint32_t all = state_.local_differences + differences;
    const std::uint32_t kept = std::min(all, kLocalWindows * differences);
    float sum = 0.0F;
    for (const float square : squares) sum += square;
    const float mean = sum * (0.5F / static_cast<float>(Axes));
    state_.local_rad2_s2 +=
        (mean - state_.local_rad2_s2 * static_cast<float>(differences)) / static_cast<float>(kept);
    state_.local_differences = static_cast<std::uint16_t>(std::min(kept, std::uint32_t{0xFFFF}));
  }

  /// Time passes without a measurement, by a model of single samples.
  constexpr void advance(std::uint32_t ticks) { track_.advance(ticks); }
  /// Squares of the samples of a tick, by a model of single samples. An axis without any noise does
  /// not exist.
  constexpr void observe_squares(const Rates& squares_rad2_s2, float samples) {
    float sum = 0.0F;
    float all_samples = 0.0F;
    for (const float square : squares_rad2_s2) {
      if (square > 0.0F) {
        sum += square;
        all_samples += samples;
      }
    }
    if (all_samples > 0.0F) track_.observe(sum / (all_samples * model_rad2_s2_), all_samples);
  }

  [[nodiscard]] constexpr WhiteKnowledge knowledge() const {
    if (!learns_ || state_.spreads == 0) return WhiteKnowledge::model;
    return state_.spreads < kSpreads ? WhiteKnowledge::seen : WhiteKnowledge::known;
  }
  /// Variance of a sample over the model's.
  [[nodiscard]] constexpr float level() const {
    return learns_ ? state_.variance_rad2_s2 / model_rad2_s2_ : model_level();
  }
  /// Level by the model of single samples; 1 where there is none.
  [[nodiscard]] constexpr float model_level() const { return track_.level(); }
  /// Variance of one sample by the spread of calm windows, whether or not it is used [rad2/s2].
  [[nodiscard]] constexpr float shown_rad2_s2() const { return state_.variance_rad2_s2; }
  /// Variance of a sample that a swaying vehicle or its engine does not explain: the lesser of what
  /// windows and what neighbouring samples show, never less than the model's. It is enlarged so
  /// that six standard deviations are as rare as if it were known.
  [[nodiscard]] constexpr float upper_variance_rad2_s2() const {
    const float shown = std::min(
        upper(state_.variance_rad2_s2, kDegreesOfSpread * static_cast<float>(state_.spreads)),
        upper(state_.local_rad2_s2,
              kDegreesOfDifference * static_cast<float>(state_.local_differences)));
    return shown < kUnknown ? std::max(shown, model_rad2_s2_)
                            : upper(model_rad2_s2_, kFewestDegrees);
  }

  /// Level that learnt figures rest on; 0: no window of a stop has shown it.
  [[nodiscard]] constexpr float reference() const { return state_.reference; }
  /// Factor from variances relative to it to true ones.
  [[nodiscard]] constexpr float scale_of_learnt() const {
    return state_.reference > 0.0F ? state_.reference : 1.0F;
  }
  constexpr void set_reference(float reference) {
    state_.reference = reference;
    state_.reference_is_known = reference > 0.0F;
  }
  /// Whether the reference is to follow the level before the next measurement is learnt from.
  [[nodiscard]] constexpr bool is_to_rebase() const {
    return knowledge() != WhiteKnowledge::model && !state_.reference_is_known;
  }
  /// Makes the level the reference.
  /// @return the factor from the old reference to the new one, or from the model to the first
  constexpr float rebase() {
    const float old = scale_of_learnt();
    state_.reference = level();
    state_.reference_is_known = knowledge() == WhiteKnowledge::known;
    return state_.reference / old;
  }
  /// Level over the reference: 1 within the error of an estimate, anything else where the sensor is
  /// shaken, or has changed.
  [[nodiscard]] constexpr float change() const {
    if (knowledge() != WhiteKnowledge::known || !state_.reference_is_known) return 1.0F;
    constexpr float kChanged = 2.0F;
    const float change = level() / state_.reference;
    return change < kChanged && change * kChanged > 1.0F ? 1.0F : change;
  }

  /// Least variance of a sample, so that a sensor that repeats one reading does not count as exact.
  /// Where its step hides the noise, that is the noise of the model or of rounding.
  [[nodiscard]] constexpr float least_rad2_s2() const {
    const float step = rounding_.step_rad_s();
    const float hidden = std::min(model_rad2_s2_, step * step * (1.0F / 12.0F));
    return std::max(kSmallest * model_rad2_s2_, hidden);
  }

  /// Rounding of the samples, which no average removes.
  [[nodiscard]] constexpr RoundingWatch<Axes>& rounding() { return rounding_; }
  [[nodiscard]] constexpr const RoundingWatch<Axes>& rounding() const { return rounding_; }

 private:
  static constexpr float kSmallest = 1e-4F;          ///< share of the model's variance
  static constexpr float kLargestRise = 8.0F;        ///< largest factor by one spread
  static constexpr std::uint8_t kSpreads = 64;       ///< memory: half a minute
  static constexpr std::uint32_t kLocalWindows = 8;  ///< memory of the differences
  // Degrees of freedom of all axes: a third of 3 and of 2 each, because neighbours share a window
  // or a sample.
  static constexpr float kDegreesOfSpread = static_cast<float>(Axes);
  static constexpr float kDegreesOfDifference = static_cast<float>(Axes) * (2.0F / 3.0F);
  static constexpr float kFewestDegrees = 6.0F;  ///< degrees of freedom that the model counts as
  static constexpr float kUnknown = std::numeric_limits<float>::infinity();

  constexpr void observe_spread(const Rates& spread, float samples) {
    float sum = 0.0F;
    float axes = 0.0F;
    for (const float one : spread) {
      if (one > 0.0F) {  // an axis without any noise does not exist
        sum += one;
        ++axes;
      }
    }
    const float shown = axes > 0.0F ? sum / axes * samples : 0.0F;
    float& variance = state_.variance_rad2_s2;
    const float bounded = state_.spreads > 0 ? std::min(shown, kLargestRise * variance) : shown;
    if (state_.spreads < kSpreads) ++state_.spreads;
    variance += (bounded - variance) / static_cast<float>(state_.spreads);
    variance = std::max(variance, least_rad2_s2());
  }

  [[gnu::noinline]] static constexpr float upper(float variance, float degrees_of_freedom) {
    constexpr float kSixSigma2 = 36.0F;
    if (degrees_of_freedom < kFewestDegrees) return kUnknown;
    return variance * student_factor(kSixSigma2, degrees_of_freedom);
  }

  float model_rad2_s2_;
  std::uint8_t window_ticks_;
  bool learns_;
  NoiseLevelTrack track_;
  RoundingWatch<Axes> rounding_;
  Measured state_{};
};

}  // namespace zerorate::core
