/// @file
/// The slow noise of one sensor at one filter tick: a level that may walk at random, and modes.
///
/// The level is the constant bias; it is unknown when the filter starts (diffuse).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/assert.hpp"
#include "core/base/time.hpp"
#include "core/noise/mode.hpp"

namespace zerorate::core {

/// Strength of every mode in the model itself.
struct AsModelled {
  constexpr float operator[](std::size_t /*mode*/) const { return 1.0F; }
};

/// Transition of R decaying modes, C rotating modes and the level over a span of ticks. A plain
/// value: transitions compose (`then`), so any gap costs the logarithm of its length and no
/// transcendental function (docs/adr/0005).
template <std::size_t R, std::size_t C>
struct Transition {
  std::uint32_t ticks = 0;
  ModeTransition<float>
      level{};  ///< never forgets: one_minus_phi_m = sum_lag = 0, sum_gain = ticks
  std::array<ModeTransition<float>, R> decaying{};
  std::array<ModeTransition<Complex>, C> rotating{};

  constexpr bool operator==(const Transition&) const = default;

  /// Variance that the whole bias gains over the span [rad2/s2].
  /// @param strength of decaying mode i: factor of its variance
  template <class Strength = AsModelled>
  [[nodiscard]] constexpr float noise(const Strength& strength = {}) const {
    return total(&ModeTransition<float>::noise, &ModeTransition<Complex>::noise, strength);
  }
  /// Variance that the sum of the bias over the span gains [rad2/s2 ticks2].
  template <class Strength = AsModelled>
  [[nodiscard]] constexpr float sum_variance(const Strength& strength = {}) const {
    return total(&ModeTransition<float>::sum_variance, &ModeTransition<Complex>::sum_variance,
                 strength);
  }

 private:
  template <class Strength>
  [[nodiscard]] constexpr float total(float ModeTransition<float>::*of_decaying,
                                      float ModeTransition<Complex>::*of_rotating,
                                      const Strength& strength) const {
    float sum = level.*of_decaying;
    for (std::size_t i = 0; i < R; ++i) sum += strength[i] * (decaying[i].*of_decaying);
    for (const auto& span : rotating) sum += span.*of_rotating;
    return sum;
  }
};

/// The span `first` followed by `second`. Cost: about 25 R + 80 C floating-point operations.
template <std::size_t R, std::size_t C>
[[nodiscard]] constexpr Transition<R, C> then(const Transition<R, C>& first,
                                              const Transition<R, C>& second) {
  Transition<R, C> both;
  both.ticks = first.ticks + second.ticks;
  both.level = then(first.level, second.level, second.ticks);
  for (std::size_t i = 0; i < R; ++i) {
    both.decaying[i] = then(first.decaying[i], second.decaying[i], second.ticks);
  }
  for (std::size_t i = 0; i < C; ++i) {
    both.rotating[i] = then(first.rotating[i], second.rotating[i], second.ticks);
  }
  return both;
}

/// Start of a filter: with the noise at zero ("type II", the paper's simulation), or with the
/// variance of a sensor that has been on for long.
enum class Start : std::uint8_t { zero, stationary };

/// Noise of a sensor at a filter tick, made by compose(). All predictors share these coefficients;
/// they never change while a filter runs.
template <std::size_t R, std::size_t C>
struct Modes {
  static constexpr std::size_t kStates = R + 2 * C;

  Duration tick;
  Start start = Start::stationary;
  bool is_stationary = true;   ///< every mode starts at, and so keeps, its stationary variance
  float walk_variance = 0.0F;  ///< variance that the level gains per tick [rad2/s2]
  std::array<DecayingMode, R> decaying{};
  std::array<RotatingMode, C> rotating{};

  constexpr bool operator==(const Modes&) const = default;
  [[nodiscard]] constexpr Transition<R, C> one_tick() const { return over(1); }

  /// Number of pieces that a span is made of: the level, and each mode.
  static constexpr std::size_t kPieces = 1 + R + C;

  /// Makes one piece of the span of `span.ticks` ticks. Cost: 2 log2(ticks) compositions of a mode.
  constexpr void make_piece(std::size_t piece, Transition<R, C>& span) const {
    if (piece == 0) {
      span.level = core::over(DecayingMode{.one_minus_phi = 0.0F, .noise_variance = walk_variance},
                              span.ticks);
    } else if (piece <= R) {
      span.decaying[piece - 1] = core::over(decaying[piece - 1], span.ticks);
    } else {
      span.rotating[piece - 1 - R] = core::over(rotating[piece - 1 - R], span.ticks);
    }
  }
  /// The span of any number of ticks.
  [[nodiscard]] constexpr Transition<R, C> over(std::uint32_t ticks) const {
    Transition<R, C> span;
    span.ticks = ticks;
    for (std::size_t piece = 0; piece < kPieces; ++piece) make_piece(piece, span);
    return span;
  }
  /// Lengthens a span by one tick, for the cost of one composition. Each piece is made afresh once
  /// in 1024 ticks, one piece at a time, so that the roundings of a long drive do not add up.
  constexpr void lengthen(Transition<R, C>& span, const Transition<R, C>& one_tick) const {
    constexpr std::uint32_t kAfresh = 1024;
    span = then(span, one_tick);
    constexpr std::uint32_t kEvery = kAfresh / static_cast<std::uint32_t>(kPieces);
    const std::uint32_t phase = span.ticks % kAfresh;
    if (phase % kEvery == 0 && phase / kEvery < kPieces) make_piece(phase / kEvery, span);
  }
};

/// Receives the modes of each block while compose() runs.
template <std::size_t R, std::size_t C>
class ModeWriter {
 public:
  constexpr explicit ModeWriter(Modes<R, C>& modes) : modes_(modes) {}

  /// A mode with its stationary variance, which is its initial one if the filter starts so.
  template <class Scalar>
  constexpr void add(Scalar forgetting, float noise_variance, float stationary_variance) {
    const Mode<Scalar> mode{
        .one_minus_phi = forgetting,
        .noise_variance = noise_variance,
        .initial_variance = modes_.start == Start::stationary ? stationary_variance : 0.0F};
    place(mode);
  }
  /// A decaying mode with a start of its own, whatever the start of the filter.
  constexpr void add_transient(float forgetting, float noise_variance, float mean, float variance) {
    if (mean != 0.0F || variance > 0.0F) modes_.is_stationary = false;
    place(DecayingMode{.one_minus_phi = forgetting,
                       .noise_variance = noise_variance,
                       .initial_variance = variance,
                       .initial_mean = mean});
  }
  constexpr void add_walk(float variance_per_tick) { modes_.walk_variance += variance_per_tick; }

 private:
  constexpr void place(const DecayingMode& mode) {
    ZERORATE_ASSERT(decaying_ < R);
    modes_.decaying[decaying_++] = mode;
  }
  constexpr void place(const RotatingMode& mode) {
    ZERORATE_ASSERT(rotating_ < C);
    modes_.rotating[rotating_++] = mode;
  }

  Modes<R, C>& modes_;
  std::size_t decaying_ = 0;
  std::size_t rotating_ = 0;
};

/// Composes noise blocks into the modes of a filter that ticks every `tick`. Each block is a plain
/// struct with kDecaying, kRotating and contribute(tick, writer); the state count follows.
template <class... Blocks>
[[nodiscard]] constexpr auto compose(Duration tick, Start start, const Blocks&... blocks) {
  Modes<(Blocks::kDecaying + ... + 0), (Blocks::kRotating + ... + 0)> modes;
  modes.tick = tick;
  modes.start = start;
  modes.is_stationary = start == Start::stationary;
  ModeWriter writer{modes};
  (blocks.contribute(tick, writer), ...);
  return modes;
}

}  // namespace zerorate::core
