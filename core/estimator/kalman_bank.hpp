/// @file
/// The Kalman predictor of a sensor's bias, for one model of its noise or for several at once.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "core/estimator/evidence.hpp"
#include "core/estimator/kalman_filter.hpp"
#include "core/estimator/prediction.hpp"

namespace zerorate::core {

/// Kalman filters of axes that are measured together, one filter for each hypothesis of the noise
/// (docs/design/learning.md). The answers are those of the mixture: its mean, and its variance.
/// With one hypothesis the bank is a plain filter of a known model.
///
/// A measurement that the gate takes for a knock is rejected on all axes and by all hypotheses.
///
/// Cost: that of KalmanFilter and of Evidence for each hypothesis; no square root. Not re-entrant.
template <ModelShape Shape, std::size_t Axes>
class KalmanBank {
 public:
  using Coefficients = KalmanCoefficients<Shape>;
  using Transition = typename Coefficients::Transition;
  using Drifts = typename Coefficients::Drifts;
  using Filter = KalmanFilter<Shape, Axes>;
  using Rates = std::array<float, Axes>;
  using Innovations = std::array<Innovation, Axes>;
  static constexpr std::size_t kAxes = Axes;
  static constexpr std::size_t kHypotheses = Shape.hypotheses;
  static constexpr bool kLearns = kHypotheses > 1;
  /// Place of the evidence where there is one hypothesis.
  struct Certainty {
    constexpr bool operator==(const Certainty&) const = default;
  };
  using Evidence = std::conditional_t<kLearns, core::Evidence<kHypotheses, Axes>, Certainty>;

  /// Everything the bank remembers: plain data, may be stored and restored bit for bit.
  struct State {
    struct Axis {
      float reference_rad_s = 0.0F;     ///< the first measurement; all else is relative to it, so
                                        ///< that a large bias does not use up the mantissa
      float rejection_variance = 0.0F;  ///< doubt that rejected measurements add [rad2/s2]

      constexpr bool operator==(const Axis&) const = default;
    };

    static constexpr std::uint16_t kNotMeasured = 0xFFFF;
    std::uint16_t confirmations_left = kNotMeasured;  ///< measurements until the first is confirmed
    std::uint16_t rejected = 0;  ///< measurements since one was accepted (see Gate)
    std::array<Axis, Axes> axes{};
    std::array<Filter, kHypotheses> filters{};
    [[no_unique_address]] Evidence evidence;

    constexpr bool operator==(const State&) const = default;
    [[nodiscard]] constexpr bool is_measured() const { return confirmations_left != kNotMeasured; }
    /// Nothing can contradict a first measurement but those that follow it: until they have for a
    /// second, it may have been anything.
    [[nodiscard]] constexpr bool is_confirmed() const { return confirmations_left == 0; }
  };
  static_assert(std::is_trivially_copyable_v<State>);

  /// Starts before the first measurement, with the modes at their initial variance.
  /// @param coefficients must outlive the bank
  constexpr explicit KalmanBank(const Coefficients& coefficients) : coefficients_(&coefficients) {
    for (std::size_t m = 0; m < count(); ++m) state_.filters[m].start(coefficients, m);
    start_learning(1.0F);
  }

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// Restores from the bytes of a state, which a stack need not hold.
  void restore(std::span<const std::uint8_t, sizeof(State)> bytes) {
    std::ranges::copy(std::as_bytes(bytes), std::as_writable_bytes(std::span{&state_, 1}).begin());
  }

  /// Biases at the newest measurement of a state, with their variances.
  [[nodiscard]] static constexpr std::array<Prediction, Axes> newest(const State& state) {
    std::array<Prediction, Axes> biases{};
    for (std::size_t i = 0; i < Axes; ++i) {
      Mixture mixture;
      for (std::size_t m = 0; m < kHypotheses; ++m) {
        float weight = 1.0F;
        float scale = 1.0F;
        if constexpr (kLearns) {
          weight = state.evidence.hypotheses[m][i].weight;
          scale = state.evidence.mean_scale(m, i);
        }
        mixture.add(weight, state.filters[m].axes[i].bias_rad_s,
                    scale * state.filters[m].bias_variance);
      }
      biases[i] = {state.axes[i].reference_rad_s + mixture.mean(),
                   mixture.variance() + state.axes[i].rejection_variance};
    }
    return biases;
  }
  /// Starts from biases that are known from elsewhere [rad/s], as from a first measurement that
  /// needs no confirmation.
  constexpr void start_from(const Rates& biases_rad_s, float variance) {
    (void)observe_first(biases_rad_s, variance);
    state_.confirmations_left = 0;
  }

  /// Weighs the hypotheses as before any measurement, all with this scale: how strong the white
  /// noise was found to be, over the model's.
  constexpr void start_learning(float scale) {
    if constexpr (kLearns) {
      state_.evidence.start(*coefficients_->hypotheses);
      rescale(scale);
    }
  }

  /// Multiplies the scales of all hypotheses.
  constexpr void rescale(float factor) {
    if constexpr (kLearns) {
      state_.evidence.rescale(factor);
      for (std::size_t m = 0; m < count(); ++m) state_.filters[m].change_unit(factor);
    }
  }

  /// Time passes. Call it before each measurement with the transition since the last.
  constexpr void advance(const Transition& span) {
    for (std::size_t m = 0; m < count(); ++m) advance(state_.filters[m], m, span);
  }

  /// Learns from the mean measured rates of this tick [rad/s].
  /// @param white_variance of each [rad2/s2]; of a learning bank the model's, times what the noise
  ///   is over that of start_learning()
  constexpr Innovations observe(const Rates& rates_rad_s, float white_variance) {
    for (const float rate_rad_s : rates_rad_s) {
      if (!is_measurement(rate_rad_s, white_variance)) return {};
    }
    if (!state_.is_measured()) return observe_first(rates_rad_s, white_variance);
    Innovations innovations = innovations_of(rates_rad_s, white_variance);
    if (coefficients_->gate.is_on()) {
      const bool is_outlier =
          std::any_of(innovations.begin(), innovations.end(),
                      [&](const Innovation& one) { return coefficients_->gate.is_outlier(one); });
      // One of the two is wrong, and nobody knows which: the newer one must be confirmed now.
      if (is_outlier && !state_.is_confirmed()) {
        return observe_first(rates_rad_s, white_variance);
      }
      if (is_knock(is_outlier, innovations)) return innovations;
    }
    if (!state_.is_confirmed()) --state_.confirmations_left;
    learn(rates_rad_s, innovations, white_variance);
    return innovations;
  }

  /// Adds the variance of an unseen change of the bias [rad2/s2].
  constexpr void inflate_variance(float variance) {
    for (std::size_t m = 0; m < count(); ++m) {
      state_.filters[m].bias_variance += variance / least_scale(m);
    }
  }

  /// Begins warm-up and ramp anew, each with another amplitude or slope: the sensor was switched on
  /// again. What the warm-up before has put on the bias is gone, what a ramp has put on it stays.
  /// docs/design/kalman-predictor.md, eq. 9b.
  constexpr void restart_transients() {
    for (std::size_t i = 0; i < Coefficients::kDecaying; ++i) {
      if (!coefficients_->is_transient(i)) continue;
      for (std::size_t m = 0; m < count(); ++m) {
        state_.filters[m].restart(*coefficients_, m, i);
      }
    }
  }

  /// Bias `lead` after the newest measurement; before the first, 0.
  [[nodiscard]] constexpr float bias_rad_s(const Transition& lead, std::size_t axis) const {
    if (!state_.is_measured()) return 0.0F;
    const Drifts g = Coefficients::movement(lead);
    float bias_rad_s = 0.0F;
    for (std::size_t m = 0; m < count(); ++m) {
      const Filter& filter = state_.filters[m];
      bias_rad_s += weight(m, axis) * (filter.axes[axis].bias_rad_s + filter.moved(g, axis));
    }
    return state_.axes[axis].reference_rad_s + bias_rad_s;
  }
  /// Biases with their variances.
  [[nodiscard]] constexpr std::array<Prediction, Axes> predict(const Transition& lead) const {
    std::array<Prediction, Axes> predictions{};
    if (!state_.is_measured()) return predictions;
    const Drifts g = Coefficients::movement(lead);
    Mixtures biases{};
    for (std::size_t m = 0; m < count(); ++m) {
      const Filter& filter = state_.filters[m];
      const float variance = filter.bias_variance + filter.moved_variance(1.0F, g) +
                             lead.noise(coefficients_->strength(m));
      for (std::size_t i = 0; i < Axes; ++i) {
        const float scale = mean_scale(m, i);
        biases[i].add(weight(m, i), filter.axes[i].bias_rad_s + filter.moved(g, i),
                      scale * variance + filter.unknown_variance(lead, i, scale));
      }
    }
    for (std::size_t i = 0; i < Axes; ++i) {
      predictions[i] = {state_.axes[i].reference_rad_s + biases[i].mean(),
                        biases[i].variance() + state_.axes[i].rejection_variance};
    }
    return predictions;
  }
  /// Integrals of the biases over `drive`, which begins `lead` after the newest measurement.
  [[nodiscard]] constexpr std::array<HeadingPrediction, Axes> predict_heading(
      const Transition& lead, const Transition& drive) const {
    if (!state_.is_measured()) return {};
    Mixtures sums{};
    for (std::size_t m = 0; m < count(); ++m) add_integral(sums, m, lead, drive);
    const auto ticks = static_cast<float>(drive.ticks);
    const float tick_s = coefficients_->tick_s;
    std::array<HeadingPrediction, Axes> headings{};
    for (std::size_t i = 0; i < Axes; ++i) {
      const typename State::Axis& x = state_.axes[i];
      const float variance = sums[i].variance() + ticks * ticks * x.rejection_variance;
      headings[i] = {(ticks * x.reference_rad_s + sums[i].mean()) * tick_s,
                     variance * tick_s * tick_s};
    }
    return headings;
  }

  /// Posterior probability of a hypothesis on an axis; 1 where there is one.
  [[nodiscard]] constexpr float weight(std::size_t m, std::size_t axis) const {
    if constexpr (kLearns) {
      if (is_learning()) return state_.evidence.hypotheses[m][axis].weight;
    }
    return 1.0F;
  }
  /// Mean of the factor that a hypothesis gives all variances of the model.
  [[nodiscard]] constexpr float mean_scale(std::size_t m, std::size_t axis) const {
    if constexpr (kLearns) {
      if (is_learning()) return state_.evidence.mean_scale(m, axis);
    }
    return 1.0F;
  }
  /// Variance of the root of that factor over its square, where the hypothesis is given.
  [[nodiscard]] constexpr float root_scale_variance() const {
    if constexpr (kLearns) {
      if (is_learning()) return state_.evidence.root_variance();
    }
    return 0.0F;
  }
  /// Expectation of figure(hypothesis) on an axis; `otherwise` where the model is known.
  template <class Figure>
  [[nodiscard]] constexpr float expected(std::size_t axis, float otherwise, Figure figure) const {
    if constexpr (kLearns) {
      if (is_learning()) {
        float sum = 0.0F;
        for (std::size_t m = 0; m < count(); ++m) {
          sum += weight(m, axis) * figure(coefficients_->hypotheses->all[m], mean_scale(m, axis));
        }
        return sum;
      }
    }
    return otherwise;
  }

 private:
  using Mixture = core::Mixture<kLearns>;
  using Mixtures = std::array<Mixture, Axes>;

  [[nodiscard]] constexpr std::size_t count() const {
    return kLearns ? coefficients_->used_hypotheses() : 1;
  }
  [[nodiscard]] constexpr bool is_learning() const { return coefficients_->hypotheses->count > 0; }
  [[nodiscard]] constexpr float least_scale(std::size_t m) const {
    float least = mean_scale(m, 0);
    for (std::size_t i = 1; i < Axes; ++i) least = std::min(least, mean_scale(m, i));
    return least;
  }

  constexpr void advance(Filter& filter, std::size_t m, const Transition& span) const {
    const Coefficients& a = *coefficients_;
    if (span.ticks == 0) return;
    if (span.ticks == 1) {
      filter.advance(typename Filter::TickWeights{span}, a.tick_noise[m], a.tick_forgetting);
    } else {
      filter.advance(typename Filter::SpanWeights{Coefficients::movement(span)},
                     a.noise_of(span, m), Coefficients::forgetting_of(span));
    }
    if constexpr (Shape.temperature_weights > 0) {
      filter.bias_variance += largest_unknown_variance(filter, m, span);
    }
  }
  /// Unknown variance of the axis with the largest slope: no interval is too narrow.
  [[nodiscard]] constexpr float largest_unknown_variance(const Filter& filter, std::size_t m,
                                                         const Transition& span) const {
    float largest = 0.0F;
    for (std::size_t i = 0; i < Axes; ++i) {
      const float scale = mean_scale(m, i);
      largest = std::max(largest, filter.unknown_variance(span, i, scale) / scale);
    }
    return largest;
  }

  [[nodiscard]] constexpr Innovations innovations_of(const Rates& rates_rad_s,
                                                     float white_variance) const {
    Innovations innovations{};
    for (std::size_t i = 0; i < Axes; ++i) {
      Mixture measured;
      for (std::size_t m = 0; m < count(); ++m) {
        const Filter& filter = state_.filters[m];
        measured.add(weight(m, i), filter.axes[i].bias_rad_s,
                     mean_scale(m, i) * (filter.bias_variance + white_variance));
      }
      innovations[i] = {
          .accepted = true,
          .residual_rad_s = (rates_rad_s[i] - state_.axes[i].reference_rad_s) - measured.mean(),
          .variance_rad2_s2 = measured.variance()};
    }
    return innovations;
  }

  /// @param innovations of the mixture; where there is one hypothesis, its own
  constexpr void learn(const Rates& rates_rad_s, const Innovations& innovations,
                       float white_variance) {
    for (std::size_t m = 0; m < count(); ++m) {
      Filter& filter = state_.filters[m];
      Rates residuals_rad_s{};
      for (std::size_t i = 0; i < Axes; ++i) {
        residuals_rad_s[i] =
            kLearns ? (rates_rad_s[i] - state_.axes[i].reference_rad_s) - filter.axes[i].bias_rad_s
                    : innovations[i].residual_rad_s;
      }
      if constexpr (kLearns) {
        for (std::size_t i = 0; i < Axes && is_learning(); ++i) {
          state_.evidence.observe(m, i, filter.bias_variance + white_variance, residuals_rad_s[i],
                                  coefficients_->hypotheses->kept);
        }
      }
      filter.update(residuals_rad_s, white_variance);
    }
    if constexpr (kLearns) {
      if (is_learning()) state_.evidence.conclude(*coefficients_->hypotheses);
    }
  }
  constexpr Innovations observe_first(const Rates& rates_rad_s, float white_variance) {
    state_.confirmations_left = coefficients_->confirmations;
    for (std::size_t m = 0; m < count(); ++m) state_.filters[m].observe_first(white_variance);
    Innovations innovations{};
    for (std::size_t i = 0; i < Axes; ++i) {
      state_.axes[i].reference_rad_s = rates_rad_s[i];
      innovations[i] = {.accepted = true, .first = true, .variance_rad2_s2 = white_variance};
    }
    return innovations;
  }

  /// Keeps account of what the gate makes of a measurement; false where it is to be learnt from.
  constexpr bool is_knock(bool is_outlier, Innovations& innovations) {
    const Gate& gate = coefficients_->gate;
    const bool is_knock = is_outlier && state_.rejected < gate.longest_knock_ticks;
    state_.rejected = is_knock ? static_cast<std::uint16_t>(state_.rejected + 1) : std::uint16_t{0};
    float largest = 0.0F;
    for (std::size_t i = 0; i < Axes; ++i) {
      const float square = innovations[i].residual_rad_s * innovations[i].residual_rad_s;
      largest = std::max(largest, square);
      innovations[i].accepted = !is_knock;
      innovations[i].rejected = is_knock;
      state_.axes[i].rejection_variance = is_knock ? gate.doubt(square, state_.rejected) : 0.0F;
    }
    if (is_outlier && !is_knock) {  // it was a jump of this size
      inflate_variance(largest);
      for (Innovation& innovation : innovations) innovation.variance_rad2_s2 += largest;
    }
    return is_knock;
  }

  /// Adds what a hypothesis says of the sum of the bias over a drive. Not inlined, so that the
  /// stack holds one filter at a time.
  [[gnu::noinline]] constexpr void add_integral(Mixtures& sums, std::size_t m,
                                                const Transition& lead,
                                                const Transition& drive) const {
    Filter at_start = state_.filters[m];
    advance(at_start, m, lead);
    const auto ticks = static_cast<float>(drive.ticks);
    const Drifts g = coefficients_->movement_of_sum(drive);
    const float variance =
        drive.sum_variance(coefficients_->strength(m)) + at_start.moved_variance(ticks, g);
    for (std::size_t i = 0; i < Axes; ++i) {
      const float scale = mean_scale(m, i);
      const float constant =
          scale * at_start.bias_variance + at_start.unknown_variance(drive, i, scale);
      sums[i].add(weight(m, i), ticks * at_start.axes[i].bias_rad_s + at_start.moved(g, i),
                  scale * variance + ticks * ticks * constant);
    }
  }

  const Coefficients* coefficients_;
  State state_{};
};

/// The promise of the product page: six decades and the bias of three axes fit into 224 bytes, and
/// twelve hypotheses of them into a page of flash.
static_assert(sizeof(KalmanBank<ModelShape{.decaying = 6}, 3>::State) <= 224);
static_assert(sizeof(KalmanBank<ModelShape{.decaying = 6, .hypotheses = 12}, 3>::State) <= 4096);

}  // namespace zerorate::core
