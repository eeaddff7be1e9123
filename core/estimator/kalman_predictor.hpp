/// @file
/// The Kalman predictor of a gyro's bias under level + modes (the paper's section IV-A with one
/// state per decade instead of one per sample).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/base/unrolled.hpp"
#include "core/estimator/kalman_coefficients.hpp"
#include "core/estimator/pair_covariance.hpp"
#include "core/estimator/prediction.hpp"
#include "core/noise/model_shape.hpp"

namespace zerorate::core {

/// Kalman filter of one axis with R decaying and C rotating modes, and with K =
/// TemperatureDrift::kWeights constants that the temperature multiplies, or none.
///
/// The first state is the whole bias s = level + sum of the modes, not the level. A measurement
/// then sees one state (h = e_0), so an update needs no matrix product and cannot cancel: the
/// variance of s is multiplied by r / S. The diffuse start is exact, without a large number. The
/// other states are the drifts w of KalmanCoefficients: s' = s + sum of w + noise.
/// docs/design/kalman-predictor.md derives it, docs/adr/0006 and 0007 compare the forms.
///
/// Cost of a tick and its measurement at R = 6, C = 0: 207 floating-point operations and one
/// division (docs/reference/benchmarks.md); no square root. Not re-entrant; one instance per axis.
template <ModelShape Shape>
class KalmanPredictor {
 public:
  static constexpr std::size_t kDecaying = Shape.decaying;
  static constexpr std::size_t kWeights = Shape.temperature_weights;
  using Coefficients = KalmanCoefficients<Shape>;
  using Transition = typename Coefficients::Transition;
  using Drifts = typename Coefficients::Drifts;
  static constexpr std::size_t kPairs = Coefficients::kPairs;

  /// Everything the filter remembers: plain data, may be stored and restored bit for bit.
  struct State {
    static constexpr std::uint16_t kNotMeasured = 0xFFFF;
    std::uint16_t confirmations_left =
        kNotMeasured;              ///< measurements that must still bear the first out
    std::uint16_t rejected = 0;    ///< measurements since one was accepted (see Gate)
    float reference_rad_s = 0.0F;  ///< the first measurement; all else is relative to it, so that a
                                   ///< large bias does not use up the mantissa
    float bias_rad_s = 0.0F;       ///< s
    float bias_variance = 0.0F;    ///< Var s [rad2/s2], if what was rejected were knocks
    float rejection_variance = 0.0F;  ///< what they add to it, because they may be none
    Drifts drift{};            ///< w [rad/s a tick]; in the last pair slope and curvature, if any
    Drifts bias_covariance{};  ///< p = Cov(s, w)
    PairCovariance<kPairs> covariance{};  ///< W = Cov(w)

    constexpr bool operator==(const State&) const = default;
    [[nodiscard]] constexpr bool is_measured() const { return confirmations_left != kNotMeasured; }
    /// Nothing can contradict a first measurement but those that follow it: until they have for a
    /// second, it may have been anything.
    [[nodiscard]] constexpr bool is_confirmed() const { return confirmations_left == 0; }
  };
  static_assert(std::is_trivially_copyable_v<State>);

  /// Starts before the first measurement, with the modes at their initial variance.
  /// @param coefficients of all axes; must outlive the predictor
  constexpr explicit KalmanPredictor(const Coefficients& coefficients)
      : coefficients_(&coefficients) {
    for (std::size_t i = 0; i < coefficients.kDrifts; ++i) {
      state_.covariance.set(i, i, coefficients.initial_variance[i]);
    }
    state_.drift = coefficients.initial_mean;
  }

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }

  /// The filter remembers across stops: nothing to do.
  constexpr void begin_stop() {}

  constexpr void advance(const Transition& span) {
    if (span.ticks > 0) advance_by(span);
  }

  /// The bias may have changed by this much, unseen.
  constexpr void inflate_variance(float variance_rad2_s2) {
    state_.bias_variance += variance_rad2_s2;
  }

  /// The sensor was switched on again: its warm-up and its ramp begin anew, each with another
  /// amplitude or slope. What the warm-up before has put on the bias is gone, what a ramp has put
  /// on it stays. docs/design/kalman-predictor.md, eq. 9b.
  constexpr void restart_transients() {
    const Coefficients& a = *coefficients_;
    for (std::size_t i = 0; i < kDecaying; ++i) {
      if (a.is_transient(i)) restart(i, a.initial_mean[i], a.initial_variance[i]);
    }
  }

  constexpr Innovation observe(float rate_rad_s, float white_variance) {
    if (!is_measurement(rate_rad_s, white_variance)) return {};
    if (!state_.is_measured()) return observe_first(rate_rad_s, white_variance);
    const float measured = rate_rad_s - state_.reference_rad_s;
    const Innovation expected{.rejected = true,
                              .residual_rad_s = measured - state_.bias_rad_s,
                              .variance_rad2_s2 = state_.bias_variance + white_variance};
    if (coefficients_->gate.is_on()) {
      const bool is_outlier = coefficients_->gate.is_outlier(expected);
      // One of the two is wrong, and nobody knows which: the newer one has to be borne out now.
      if (is_outlier && !state_.is_confirmed()) return observe_first(rate_rad_s, white_variance);
      if (is_knock(is_outlier, expected)) return expected;
    }
    count_confirmation();
    Registers x{state_};
    const Innovation innovation = x.observe(measured, white_variance);
    x.store(state_);
    return innovation;
  }

  /// advance() and observe() in one, which for a single tick without a gate is much quicker.
  constexpr Innovation step(const Transition& span, float rate_rad_s, float white_variance) {
    if (span.ticks == 1 && is_temperature_known(span) && state_.is_measured() &&
        is_measurement(rate_rad_s, white_variance) && !coefficients_->gate.is_on()) {
      count_confirmation();
      Registers x{state_};
      x.advance(*coefficients_, span);
      const Innovation innovation = x.observe(rate_rad_s - state_.reference_rad_s, white_variance);
      x.store(state_);
      return innovation;
    }
    advance(span);
    return observe(rate_rad_s, white_variance);
  }

  [[nodiscard]] constexpr float bias_rad_s(const Transition& lead) const {
    if (!state_.is_measured()) return 0.0F;
    return state_.reference_rad_s +
           (state_.bias_rad_s + dot(Coefficients::movement(lead), state_.drift));
  }

  [[nodiscard]] constexpr Prediction predict(const Transition& lead) const {
    if (!state_.is_measured()) return {};
    const State& x = state_;
    const Drifts g = Coefficients::movement(lead);
    const float moved = 2.0F * dot(g, x.bias_covariance) + dot(g, times_covariance(g));
    return {x.reference_rad_s + (x.bias_rad_s + dot(g, x.drift)),
            with_unknown(x.bias_variance + x.rejection_variance + moved, lead) + lead.noise()};
  }

  [[nodiscard]] constexpr HeadingPrediction predict_heading(const Transition& lead,
                                                            const Transition& drive) const {
    if (!state_.is_measured()) return {};
    KalmanPredictor at_start = *this;
    at_start.advance(lead);
    return at_start.integrate(drive);
  }

 private:
  static constexpr std::size_t kModePairs = Coefficients::kModePairs;
  using Blocks = std::array<Block, kPairs>;
  static_assert(kPairs > 0);

  [[nodiscard]] static constexpr bool is_temperature_known(const Transition& span) {
    if constexpr (kWeights > 0) return span.temperature.is_known();
    return true;
  }
  /// A variance of the bias, and what the bias may have done because the temperature was not known:
  /// the expectation of the square of (unknown change of the weights)' (constants).
  [[nodiscard]] constexpr float with_unknown(float variance, const Transition& span) const {
    if constexpr (kWeights > 0) {
      const auto& u = span.temperature.unknown;
      constexpr std::size_t kFirst = Coefficients::kTemperature;
      for (std::size_t i = 0; i < kWeights; ++i) {
        for (std::size_t j = 0; j < kWeights; ++j) {
          variance += u[i] * u[j] *
                      (state_.drift[kFirst + i] * state_.drift[kFirst + j] +
                       state_.covariance(kFirst + i, kFirst + j));
        }
      }
    }
    return variance;
  }

  constexpr Innovation observe_first(float rate_rad_s, float white_variance) {
    // A diffuse level: s is what was measured, and its error is independent of the modes.
    state_.confirmations_left = coefficients_->confirmations;
    state_.reference_rad_s = rate_rad_s;
    state_.bias_rad_s = 0.0F;
    state_.bias_variance = white_variance;
    state_.bias_covariance = {};
    return {.accepted = true, .first = true, .variance_rad2_s2 = white_variance};
  }

  constexpr void count_confirmation() {
    if (!state_.is_confirmed()) --state_.confirmations_left;
  }

  /// Puts another drift in the place of drift i, independent of all that is known.
  constexpr void restart(std::size_t i, float mean, float variance) {
    State& x = state_;
    const float share = coefficients_->contribution(i);
    x.bias_rad_s += share * (mean - x.drift[i]);
    x.bias_variance +=
        share * (share * (x.covariance(i, i) + variance) - 2.0F * x.bias_covariance[i]);
    for (std::size_t j = 0; j < x.drift.size(); ++j) {
      x.bias_covariance[j] -= share * x.covariance(i, j);
      x.covariance.set(i, j, 0.0F);
    }
    x.drift[i] = mean;
    x.bias_covariance[i] = share * variance;
    x.covariance.set(i, i, variance);
  }

  /// Keeps account of what the gate makes of a measurement; false where it is to be learnt from.
  constexpr bool is_knock(bool is_outlier, const Innovation& expected) {
    const Gate& gate = coefficients_->gate;
    const float square = expected.residual_rad_s * expected.residual_rad_s;
    if (is_outlier && state_.rejected < gate.longest_knock_ticks) {
      ++state_.rejected;
      state_.rejection_variance = square * static_cast<float>(state_.rejected) /
                                  static_cast<float>(gate.longest_knock_ticks);
      return true;
    }
    if (is_outlier) state_.bias_variance += square;  // it was a jump of about this size
    state_.rejected = 0;
    state_.rejection_variance = 0.0F;
    return false;
  }

  /// The state while it is computed with. Nothing in here goes through memory: see unrolled().
  struct Registers {
    float bias;
    float variance;
    Blocks drift;                                           ///< in both rows
    Blocks cross;                                           ///< p, in both rows
    std::array<Block, kPairs*(kPairs + 1) / 2> covariance;  ///< on and below the diagonal

    [[gnu::always_inline]] explicit Registers(const State& state)
        : bias(state.bias_rad_s), variance(state.bias_variance) {
      unrolled<kPairs>([&](auto i) __attribute__((always_inline)) {
        drift[i] = rows(&state.drift[2 * i]);
        cross[i] = rows(&state.bias_covariance[2 * i]);
        unrolled<i + 1>([&](auto j) __attribute__((always_inline)) {
          covariance[below(i, j)] = state.covariance.block(i, j);
        });
      });
    }
    [[gnu::always_inline]] void store(State& state) const {
      state.bias_rad_s = bias;
      state.bias_variance = variance;
      unrolled<kPairs>([&](auto i) __attribute__((always_inline)) {
        store_row(drift[i], &state.drift[2 * i]);
        store_row(cross[i], &state.bias_covariance[2 * i]);
        unrolled<i + 1>([&](auto j) __attribute__((always_inline)) {
          state.covariance.set_block(i, j, covariance[below(i, j)]);
        });
      });
    }

    /// One tick: s' = s + 1'w, v' = v + 1'(2 p + W 1) + Q, p' = F (p + W 1) + cross noise,
    /// W' = F W F' + noise. For the constants of the temperature the change of their weights stands
    /// in the place of 1.
    [[gnu::always_inline]] void advance(const Coefficients& a, const Transition& span) {
      Blocks moved;  // W 1
      unrolled<kPairs>([&](auto i)
                           __attribute__((always_inline)) { moved[i] = row_sums(i, span); });
      const float cross_sum = sum(cross, span);
      variance = ((variance + a.bias_noise) + (cross_sum + cross_sum)) + sum(moved, span);
      bias += sum(drift, span);
      unrolled<kPairs>([&](auto i) __attribute__((always_inline)) {
        drift[i] = a.kept_row(i, drift[i]);
        cross[i] = a.kept_row(i, cross[i] + moved[i]) + rows(&a.cross_noise[2 * i]);
        unrolled<i>([&](auto j) __attribute__((always_inline)) {
          covariance[below(i, j)] = a.kept_block(i, j, covariance[below(i, j)]);
        });
        covariance[below(i, i)] =
            symmetric(a.kept_block(i, i, covariance[below(i, i)]) +
                      diagonal(a.drift_noise[2 * i], a.drift_noise[2 * i + 1]));
      });
    }

    /// K = (v, p) / S; s += K_0 e, w += K e, v *= r / S, p *= r / S, W -= K p'.
    [[gnu::always_inline]] Innovation observe(float measured, float white_variance) {
      const Innovation innovation{.accepted = true,
                                  .residual_rad_s = measured - bias,
                                  .variance_rad2_s2 = variance + white_variance};
      const float inverse = 1.0F / innovation.variance_rad2_s2;
      const float remaining = white_variance * inverse;  // 1 - K_0, without the difference
      bias += variance * (innovation.residual_rad_s * inverse);
      variance *= remaining;
      unrolled<kPairs>([&](auto i) __attribute__((always_inline)) {
        const Block gain = cross[i] * all(inverse);
        drift[i] = drift[i] + gain * all(innovation.residual_rad_s);
        unrolled<i>([&](auto j) __attribute__((always_inline)) {
          covariance[below(i, j)] = covariance[below(i, j)] - transposed(gain) * cross[j];
        });
        covariance[below(i, i)] = symmetric(covariance[below(i, i)] - transposed(gain) * cross[i]);
      });
      unrolled<kPairs>([&](auto i) __attribute__((always_inline)) {
        cross[i] = cross[i] * all(remaining);
      });
      return innovation;
    }

   private:
    static constexpr std::size_t below(std::size_t i, std::size_t j) { return i * (i + 1) / 2 + j; }

    /// The row sums of the covariance that belong to pair i, in both rows.
    template <class Index>
    [[gnu::always_inline]] Block row_sums(Index i, const Transition& span) const {
      Block columns = by_row(i, covariance[below(i, i)], span);
      unrolled<kPairs>([&](auto j) __attribute__((always_inline)) {
        if constexpr (j < i) {
          columns = columns + by_row(j, transposed(covariance[below(i, j)]), span);
        }
        if constexpr (j > i) columns = columns + by_row(j, covariance[below(j, i)], span);
      });
      return columns + rows_exchanged(columns);
    }
    [[gnu::always_inline]] static float sum(const Blocks& of_rows, const Transition& span) {
      Block total = of_rows[0];
      unrolled<kModePairs - 1>([&](auto i) __attribute__((always_inline)) {
        total = total + of_rows[i + 1];
      });
      if constexpr (kWeights > 0)
        total = total + of_rows[kModePairs] * rows(&span.temperature.change[0]);
      return sum_of_row(total);
    }
    /// The rows of pair j, each by what it moves the bias.
    template <class Index>
    [[gnu::always_inline]] static Block by_row(Index /*j*/, Block block, const Transition& span) {
      if constexpr (Index::value < kModePairs) {
        return block;
      } else {
        return block * transposed(rows(&span.temperature.change[0]));
      }
    }
  };

  /// Any span: every drift moves the bias by a weight of its own.
  constexpr void advance_by(const Transition& span) {
    State& x = state_;
    const Coefficients& a = *coefficients_;
    const Drifts g = Coefficients::movement(span);
    const Drifts moved = times_covariance(g);
    x.bias_variance += 2.0F * dot(g, x.bias_covariance) + dot(g, moved) + span.noise();
    x.bias_variance = with_unknown(x.bias_variance, span);
    x.bias_rad_s += dot(g, x.drift);
    const Drifts cross_noise = a.cross_noise_of(span);
    const Drifts drift_noise = a.drift_noise_of(span);
    for (std::size_t i = 0; i < kPairs; ++i) {
      const auto forgetting = Coefficients::of_pair(span, i);
      const Block p = rows(&x.bias_covariance[2 * i]) + rows(&moved[2 * i]);
      store_row(forgetting.kept_row(rows(&x.drift[2 * i])), &x.drift[2 * i]);
      store_row(forgetting.kept_row(p) + rows(&cross_noise[2 * i]), &x.bias_covariance[2 * i]);
      for (std::size_t j = 0; j <= i; ++j) {
        x.covariance.set_block(
            i, j, forgetting.kept(x.covariance.block(i, j), Coefficients::of_pair(span, j)));
      }
      x.covariance.set_block(i, i,
                             symmetric(x.covariance.block(i, i) +
                                       diagonal(drift_noise[2 * i], drift_noise[2 * i + 1])));
    }
  }

  /// The sum of the bias over a drive that begins now, with its variance.
  [[nodiscard]] constexpr HeadingPrediction integrate(const Transition& drive) const {
    const State& x = state_;
    const auto ticks = static_cast<float>(drive.ticks);
    const Drifts g = coefficients_->movement_of_sum(drive);
    const float sum = ticks * x.bias_rad_s + dot(g, x.drift);
    const float variance =
        ticks * ticks * with_unknown(x.bias_variance + x.rejection_variance, drive) +
        drive.sum_variance() + 2.0F * ticks * dot(g, x.bias_covariance) +
        dot(g, times_covariance(g));
    const float tick_s = coefficients_->tick_s;
    return {(ticks * x.reference_rad_s + sum) * tick_s, variance * tick_s * tick_s};
  }

  [[nodiscard]] static constexpr float dot(const Drifts& a, const Drifts& b) {
    float sum = 0.0F;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
  }
  [[nodiscard]] constexpr Drifts times_covariance(const Drifts& g) const {
    Drifts product{};
    for (std::size_t i = 0; i < g.size(); ++i) {
      for (std::size_t j = 0; j < g.size(); ++j) product[i] += state_.covariance(i, j) * g[j];
    }
    return product;
  }

  const Coefficients* coefficients_;
  State state_{};
};

/// The promise of the product page: six decades and the bias fit into 192 bytes an axis.
static_assert(sizeof(KalmanPredictor<ModelShape{.decaying = 6}>::State) <= 192);

}  // namespace zerorate::core
