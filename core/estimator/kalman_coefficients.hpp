/// @file
/// What the Kalman predictors of all axes share: the noise in the coordinates of the filter.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/estimator/gate.hpp"
#include "core/estimator/pair_covariance.hpp"
#include "core/noise/model_shape.hpp"
#include "core/noise/temperature_drift.hpp"

namespace zerorate::core {

/// What a pair of drifts forgets over a span: F X = X - straight X - crossed (X, rows exchanged),
/// element by element.
struct PairForgetting {
  Block straight;
  Block crossed;

  /// F X.
  [[gnu::always_inline]] [[nodiscard]] Block kept(Block x) const {
    return x - (straight * x + crossed * rows_exchanged(x));
  }
  /// F X G'.
  [[gnu::always_inline]] [[nodiscard]] Block kept(Block x, const PairForgetting& g) const {
    return transposed(g.kept(transposed(kept(x))));
  }
  /// F x of a vector, which stands in both rows.
  [[gnu::always_inline]] [[nodiscard]] Block kept_row(Block x) const {
    return transposed(kept(transposed(x)));
  }
};

/// The filter does not hold a mode z but its drift w = beta z, scaled so that the bias moves over
/// one tick by the plain sum of the drifts: w = -alpha z for a decaying mode. Drifts come in pairs:
/// two decaying modes (an odd one beside a zero), or the two components of a rotating one, which
/// beta = -(1 + j) alpha / 2 turns so that their sum is Re(-alpha z).
/// docs/design/kalman-predictor.md, eq. 6.
///
/// With K = TemperatureDrift::kWeights the last pair is no drift but slope and curvature:
/// constants, which move the bias by the changes of their weights.
template <ModelShape Shape>
struct KalmanCoefficients {
  static constexpr std::size_t kDecaying = Shape.decaying;
  static constexpr std::size_t kRotating = Shape.rotating;
  static constexpr std::size_t kWeights = Shape.temperature_weights;
  static_assert(kWeights == 0 || kWeights == TemperatureDrift::kWeights);
  static constexpr std::size_t kDecayingPairs = (kDecaying + 1) / 2;
  static constexpr std::size_t kModePairs = kDecayingPairs + kRotating;
  static constexpr std::size_t kPairs = kModePairs + kWeights / 2;
  static constexpr std::size_t kDrifts = 2 * kPairs;
  using Drifts = std::array<float, kDrifts>;
  using Transition = FilterTransition<Shape>;

  /// The drift that holds the real part of a rotating mode; the imaginary part is the next.
  static constexpr std::size_t rotating(std::size_t i) { return 2 * (kDecayingPairs + i); }
  /// Where the temperature's constants stand.
  static constexpr std::size_t kTemperature = 2 * kModePairs;

  float tick_s = 0.0F;
  Gate gate;
  std::uint16_t confirmations = 1;  ///< measurements that must bear the first one out: of a second
  float bias_noise = 0.0F;          ///< what the bias gains in a tick [rad2/s2]
  Drifts cross_noise{};             ///< covariance of that with what the drifts gain
  Drifts drift_noise{};             ///< variance that the drifts gain
  Drifts initial_variance{};
  Drifts initial_mean{};
  Drifts forgotten{};                             ///< alpha of the decaying modes
  std::array<Complex, kRotating> turned{};        ///< alpha of the rotating modes
  PairCovariance<kDecayingPairs> pair_forgotten;  ///< 1 - (1 - alpha_i)(1 - alpha_j)
  std::array<float, kDecaying> decaying_scale{};  ///< beta
  std::array<Complex, kRotating> rotating_scale{};

  constexpr explicit KalmanCoefficients(const ModesOf<Shape>& modes,
                                        const Gate& innovation_gate = {},
                                        const TemperatureBlock<kWeights>& temperature = {})
      : tick_s(modes.tick.in_seconds()),
        gate(innovation_gate),
        confirmations(confirmations_at(modes.tick)),
        bias_noise(modes.one_tick().noise()) {
    for (std::size_t i = 0; i < kDecaying; ++i) {
      const DecayingMode& mode = modes.decaying[i];
      forgotten[i] = mode.one_minus_phi;
      decaying_scale[i] = -mode.one_minus_phi;
      for (std::size_t j = 0; j <= i; ++j) {
        pair_forgotten.set(i, j, forgotten[i] + forgotten[j] - forgotten[i] * forgotten[j]);
      }
      initial_variance[i] = decaying_scale[i] * decaying_scale[i] * mode.initial_variance;
      initial_mean[i] = decaying_scale[i] * mode.initial_mean;
    }
    for (std::size_t i = 0; i < kRotating; ++i) {
      const RotatingMode& mode = modes.rotating[i];
      turned[i] = mode.one_minus_phi;
      rotating_scale[i] = Complex{-0.5F, -0.5F} * mode.one_minus_phi;
      initial_variance[rotating(i)] = initial_variance[rotating(i) + 1] =
          squared_magnitude(rotating_scale[i]) * mode.initial_variance;
    }
    if constexpr (kWeights > 0) {
      initial_mean[kTemperature] = temperature.slope_rad_s_per_k;
      initial_mean[kTemperature + 1] = temperature.curvature_rad_s_per_k2;
      initial_variance[kTemperature] =
          temperature.slope_sigma_rad_s_per_k * temperature.slope_sigma_rad_s_per_k;
      initial_variance[kTemperature + 1] =
          temperature.curvature_sigma_rad_s_per_k2 * temperature.curvature_sigma_rad_s_per_k2;
    }
    const TransitionOf<Shape> tick = modes.one_tick();
    cross_noise = cross_noise_of(tick);
    drift_noise = drift_noise_of(tick);
  }

  /// Whether drift i belongs to a warm-up or a ramp: it starts with a mean or with more variance
  /// than its noise keeps up.
  [[nodiscard]] constexpr bool is_transient(std::size_t i) const {
    return initial_mean[i] != 0.0F || drift_noise[i] < 0.5F * forgotten[i] * initial_variance[i];
  }
  /// What a drift of 1 has put on the bias, if that ends with the drift: a ramp's stays.
  [[nodiscard]] constexpr float contribution(std::size_t i) const {
    return forgotten[i] > kNearlyConstant ? -1.0F / forgotten[i] : 0.0F;
  }

  [[nodiscard]] constexpr Drifts cross_noise_of(const TransitionOf<Shape>& span) const {
    Drifts noise{};
    for (std::size_t i = 0; i < kDecaying; ++i)
      noise[i] = decaying_scale[i] * span.decaying[i].noise;
    for (std::size_t i = 0; i < kRotating; ++i) {
      noise[rotating(i)] = rotating_scale[i].re * span.rotating[i].noise;
      noise[rotating(i) + 1] = rotating_scale[i].im * span.rotating[i].noise;
    }
    return noise;
  }
  [[nodiscard]] constexpr Drifts drift_noise_of(const TransitionOf<Shape>& span) const {
    Drifts noise{};
    for (std::size_t i = 0; i < kDecaying; ++i) {
      noise[i] = decaying_scale[i] * decaying_scale[i] * span.decaying[i].noise;
    }
    for (std::size_t i = 0; i < kRotating; ++i) {
      noise[rotating(i)] = noise[rotating(i) + 1] =
          squared_magnitude(rotating_scale[i]) * span.rotating[i].noise;
    }
    return noise;
  }

  /// What pair i forgets over a span.
  [[nodiscard]] static PairForgetting of_pair(const TransitionOf<Shape>& span, std::size_t i) {
    if (i >= kModePairs) return of_constants();
    if (i >= kDecayingPairs) return of_rotating(span.rotating[i - kDecayingPairs].one_minus_phi_m);
    const std::size_t second = 2 * i + 1;
    return of_decaying(span.decaying[2 * i].one_minus_phi_m,
                       second < kDecaying ? span.decaying[second].one_minus_phi_m : 0.0F);
  }
  /// The same over a tick.
  [[gnu::always_inline]] [[nodiscard]] PairForgetting of_pair(std::size_t i) const {
    if (i >= kModePairs) return of_constants();
    return i < kDecayingPairs ? of_decaying(forgotten[2 * i], forgotten[2 * i + 1])
                              : of_rotating(turned[i - kDecayingPairs]);
  }

  /// F w of pair i over a tick; slow modes lose a small share of themselves, which is subtracted.
  template <class Index>
  [[gnu::always_inline]] [[nodiscard]] Block kept_row(Index i, Block x) const {
    if constexpr (i < kDecayingPairs) {
      return x - rows(&forgotten[2 * i]) * x;
    } else if constexpr (i >= kModePairs) {
      return x;
    } else {
      return of_pair(i).kept_row(x);
    }
  }
  /// F_i W_ij F_j' over a tick, j <= i.
  template <class Row, class Column>
  [[gnu::always_inline]] [[nodiscard]] Block kept_block(Row i, Column j, Block x) const {
    if constexpr (i < kDecayingPairs) {
      return x - pair_forgotten.block(i, j) * x;
    } else {
      return of_pair(i).kept(x, of_pair(j));
    }
  }

  /// How far the bias moves over a span by each drift: (1 - F^m) / (1 - F), all ones for a tick;
  /// and by each constant: the change of its weight.
  [[nodiscard]] static constexpr Drifts movement(const Transition& span) {
    Drifts weight{};
    for (std::size_t i = 0; i < kDecaying; ++i) {
      weight[i] = span.decaying[i].sum_gain + span.decaying[i].one_minus_phi_m;
    }
    for (std::size_t i = 0; i < kRotating; ++i) {
      set_rotating(weight, i, span.rotating[i].sum_gain + span.rotating[i].one_minus_phi_m);
    }
    if constexpr (kWeights > 0) set_temperature(weight, span.temperature.change);
    return weight;
  }
  /// The same for the sum of the bias over the ticks of a span: lag / alpha.
  [[nodiscard]] constexpr Drifts movement_of_sum(const Transition& span) const {
    Drifts weight{};
    for (std::size_t i = 0; i < kDecaying; ++i) weight[i] = span.decaying[i].sum_lag / forgotten[i];
    for (std::size_t i = 0; i < kRotating; ++i) {
      const Complex over_square = Complex{1.0F / squared_magnitude(turned[i])};
      set_rotating(weight, i, span.rotating[i].sum_lag * conjugate(turned[i]) * over_square);
    }
    if constexpr (kWeights > 0) set_temperature(weight, span.temperature.sum);
    return weight;
  }

 private:
  static constexpr std::uint16_t confirmations_at(Duration tick) {
    constexpr std::int64_t kMost = 0xFFFE;
    return static_cast<std::uint16_t>(
        std::clamp(Duration::seconds(1) / tick, std::int64_t{1}, kMost));
  }

  [[gnu::always_inline]] static PairForgetting of_decaying(float first, float second) {
    return {Block{first, first, second, second}, all(0.0F)};
  }
  [[gnu::always_inline]] static PairForgetting of_rotating(Complex share) {
    return {all(share.re), Block{-share.im, -share.im, share.im, share.im}};
  }

  [[gnu::always_inline]] static PairForgetting of_constants() { return {all(0.0F), all(0.0F)}; }

  static constexpr void set_temperature(Drifts& weight,
                                        const std::array<float, kWeights>& of_constants) {
    for (std::size_t i = 0; i < kWeights; ++i) weight[kTemperature + i] = of_constants[i];
  }

  /// The bias moves by Re((1 - j) share w).
  static constexpr void set_rotating(Drifts& weight, std::size_t i, Complex share) {
    const Complex factor = Complex{1.0F, -1.0F} * share;
    weight[rotating(i)] = factor.re;
    weight[rotating(i) + 1] = -factor.im;
  }
};

template <std::size_t R, std::size_t C>
KalmanCoefficients(const Modes<R, C>&, const Gate& = {})
    -> KalmanCoefficients<ModelShape{.decaying = R, .rotating = C}>;

}  // namespace zerorate::core
