/// @file
/// The Kalman predictor of a sensor's bias, for one model of its noise or for several at once.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "core/estimator/bank_forecast.hpp"
#include "core/estimator/bank_state.hpp"
#include "core/estimator/kalman_coefficients.hpp"
#include "core/estimator/prediction.hpp"

namespace zerorate::core {

/// Kalman filters of axes that are measured together, one filter for each hypothesis of the noise
/// (docs/design/learning.md). The answers are those of the mixture: its mean, and its variance.
/// With one hypothesis the bank is a plain filter of a known model.
///
/// A measurement that the gate takes for a knock is rejected on all axes and by all hypotheses.
///
/// A measurement is learnt in pieces, so that a board can spread them over time: advance() for each
/// hypothesis, compare(), learn() for each hypothesis, conclude(), weigh() for each axis. observe()
/// does all but the first. Forecasts are valid in between (BankLead).
///
/// Cost: that of KalmanFilter and of Evidence for each hypothesis; no square root. Not re-entrant.
template <ModelShape Shape, std::size_t Axes>
class KalmanBank {
 public:
  using Coefficients = KalmanCoefficients<Shape>;
  using Transition = typename Coefficients::Transition;
  using State = BankState<Shape, Axes>;
  using Filter = typename State::Filter;
  using Forecast = BankForecast<Shape, Axes>;
  using Lead = typename Forecast::Lead;
  using Rates = std::array<float, Axes>;
  using Innovations = std::array<Innovation, Axes>;
  static constexpr std::size_t kAxes = Axes;
  static constexpr std::size_t kHypotheses = Shape.hypotheses;
  static constexpr bool kLearns = State::kLearns;
  static_assert(std::is_trivially_copyable_v<State>);

  /// Starts before the first measurement, with the modes at their initial variance.
  /// @param coefficients must outlive the bank
  constexpr explicit KalmanBank(const Coefficients& coefficients) : coefficients_(&coefficients) {
    for (std::size_t m = 0; m < count(); ++m) state_.filters[m].start(coefficients, m);
    start_learning(1.0F);
    for (std::size_t i = 0; i < Axes; ++i) weigh(i);
  }

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }
  /// Restores from the bytes of a state, which a stack need not hold.
  void restore(std::span<const std::uint8_t, sizeof(State)> bytes) {
    std::ranges::copy(std::as_bytes(bytes), std::as_writable_bytes(std::span{&state_, 1}).begin());
  }
  [[nodiscard]] constexpr Forecast forecast() const { return {*coefficients_, state_}; }
  [[nodiscard]] constexpr std::size_t count() const { return forecast().count(); }
  [[nodiscard]] constexpr bool is_learning() const { return forecast().is_learning(); }

  /// Starts from biases that are known from elsewhere [rad/s], as from a first measurement that
  /// needs no confirmation.
  constexpr void start_from(const Rates& biases_rad_s, float variance) {
    (void)observe_first(biases_rad_s, variance);
    state_.confirmations_left = 0;
  }

  /// Begins to weigh the hypotheses anew, all with this scale: the variance of the white noise over
  /// the model's. The probabilities follow with weigh().
  constexpr void start_learning(float scale) {
    if constexpr (kLearns) state_.evidence.start(*coefficients_->hypotheses, scale);
  }
  /// Multiplies the scale of a hypothesis.
  constexpr void rescale(std::size_t m, float factor) {
    if constexpr (kLearns) {
      state_.evidence.rescale(m, factor);
      change_unit(m, factor);
    }
  }
  /// The unit of the variances of filter m is larger by this factor than was assumed.
  constexpr void change_unit(std::size_t m, float factor) { state_.filters[m].change_unit(factor); }

  /// Time passes. Call it before each measurement with the transition since the last.
  constexpr void advance(const Transition& span) {
    for (std::size_t m = 0; m < count(); ++m) advance(m, span);
  }
  /// Time passes for the filter of one hypothesis.
  constexpr void advance(std::size_t m, const Transition& span) {
    const Coefficients& a = *coefficients_;
    Filter& filter = state_.filters[m];
    if (span.ticks == 0) return;
    if (span.ticks == 1) {
      filter.advance(typename Filter::TickWeights{span}, a.tick_noise[m], a.tick_forgetting);
    } else {
      filter.advance(typename Filter::SpanWeights{Coefficients::movement(span)},
                     a.noise_of(span, m), Coefficients::forgetting_of(span));
    }
    filter.bias_variance += forecast().largest_unknown_variance(m, span);
  }

  /// Learns from the mean measured rates of this tick [rad/s].
  /// @param white_variance variance of each [rad2/s2]; of a learning bank the model's, times the
  ///   change since the level that its scales rest on
  constexpr Innovations observe(const Rates& rates_rad_s, float white_variance) {
    Innovations innovations{};
    if (!compare(rates_rad_s, white_variance, false, innovations)) return innovations;
    for (std::size_t m = 0; m < count(); ++m) learn(m, rates_rad_s, white_variance, innovations);
    conclude();
    for (std::size_t i = 0; i < Axes; ++i) weigh(i);
    return innovations;
  }

  /// Compares a measurement with the forecast, and decides whether the filters are to learn it.
  /// A first measurement is taken up here.
  /// @param has_jumped whether the level is known to have changed: then it is learnt anew
  /// @return true if learn(), conclude() and weigh() are to follow
  constexpr bool compare(const Rates& rates_rad_s, float white_variance, bool has_jumped,
                         Innovations& innovations) {
    innovations = {};
    for (const float rate_rad_s : rates_rad_s) {
      if (!is_measurement(rate_rad_s, white_variance)) return false;
    }
    if (!state_.is_measured()) {
      innovations = observe_first(rates_rad_s, white_variance);
      return false;
    }
    innovations = innovations_of(rates_rad_s, white_variance);
    if (has_jumped && state_.is_confirmed()) {
      count_rejected(false, innovations);
      inflate_variance(largest_square(innovations));
      return true;
    }
    const bool is_outlier = is_outlier_to_gate(innovations);
    // One of the two is wrong, and nobody knows which: the newer one must be confirmed now.
    if (is_outlier && !state_.is_confirmed()) {
      innovations = observe_first(rates_rad_s, white_variance);
      return false;
    }
    if (coefficients_->gate.is_on() && is_knock(is_outlier, innovations)) return false;
    if (!state_.is_confirmed()) --state_.confirmations_left;
    return true;
  }
  /// The newest measurement was borne out before it was learnt.
  constexpr void confirm() {
    if (state_.is_measured()) state_.confirmations_left = 0;
  }
  /// The filter of one hypothesis learns.
  /// @param innovations of the mixture; where there is one hypothesis, its own
  constexpr void learn(std::size_t m, const Rates& rates_rad_s, float white_variance,
                       const Innovations& innovations) {
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
  /// All hypotheses have learnt.
  constexpr void conclude() {
    if constexpr (kLearns) {
      if (is_learning()) state_.evidence.conclude(*coefficients_->hypotheses);
    }
  }
  /// Weighs the hypotheses on an axis.
  constexpr void weigh(std::size_t axis) {
    if constexpr (kLearns) {
      if (is_learning()) state_.evidence.weigh(*coefficients_->hypotheses, axis);
    }
  }

  /// Adds the variance of an unseen change of the bias [rad2/s2].
  constexpr void inflate_variance(float variance) {
    for (std::size_t m = 0; m < count(); ++m) {
      state_.filters[m].bias_variance += variance / least_scale(m);
    }
  }

  /// Begins warm-up and ramp anew, each with another amplitude or slope: the sensor was switched on
  /// again. What the warm-up before has put on the bias is gone, what a ramp has put on it stays.
  /// docs/design/kalman-predictor.md, eq. 9a.
  constexpr void restart_transients() {
    for (std::size_t i = 0; i < Coefficients::kDecaying; ++i) {
      if (!coefficients_->is_transient(i)) continue;
      for (std::size_t m = 0; m < count(); ++m) {
        state_.filters[m].restart(*coefficients_, m, i);
      }
    }
  }

  /// Forecasts of a bank that is not learning at this moment; see BankForecast.
  [[nodiscard]] constexpr float bias_rad_s(const Transition& lead, std::size_t axis) const {
    return forecast().bias_rad_s({lead, lead}, axis);
  }
  [[nodiscard]] constexpr std::array<Prediction, Axes> predict(const Transition& lead) const {
    return forecast().predict({lead, lead});
  }
  [[nodiscard]] constexpr std::array<HeadingPrediction, Axes> predict_heading(
      const Transition& lead, const Transition& drive) const {
    return forecast().predict_heading({lead, lead}, drive);
  }

  /// Variance of the root of a scale over its square, where the hypothesis is given.
  [[nodiscard]] constexpr float root_scale_variance() const {
    if constexpr (kLearns) {
      if (is_learning()) return state_.evidence.root_variance();
    }
    return 0.0F;
  }
  /// Coefficient of an input on an axis as it was learnt [rad/s per unit of the input]: the mean
  /// over the hypotheses. Before a measurement it is what the model expects.
  [[nodiscard]] constexpr float coefficient(std::size_t input, std::size_t axis) const {
    static_assert(Shape.inputs > 0);
    float mean = 0.0F;
    for (std::size_t m = 0; m < count(); ++m) {
      const auto& drift = state_.filters[m].axes[axis].drift;
      mean += state_.weight(m, axis) * drift[Coefficients::kFirstInput + input];
    }
    return mean;
  }
  /// Expectation of figure(hypothesis) on an axis; `otherwise` where the model is known.
  template <class Figure>
  [[nodiscard]] constexpr float expected(std::size_t axis, float otherwise, Figure figure) const {
    if constexpr (kLearns) {
      if (is_learning()) {
        float sum = 0.0F;
        for (std::size_t m = 0; m < count(); ++m) {
          sum += state_.weight(m, axis) *
                 figure(coefficients_->hypotheses->all[m], state_.mean_scale(m, axis));
        }
        return sum;
      }
    }
    return otherwise;
  }

 private:
  [[nodiscard]] constexpr float least_scale(std::size_t m) const {
    float least = state_.mean_scale(m, 0);
    for (std::size_t i = 1; i < Axes; ++i) least = std::min(least, state_.mean_scale(m, i));
    return least;
  }

  [[nodiscard]] constexpr Innovations innovations_of(const Rates& rates_rad_s,
                                                     float white_variance) const {
    Innovations innovations{};
    for (std::size_t i = 0; i < Axes; ++i) {
      Mixture<kLearns> measured;
      for (std::size_t m = 0; m < count(); ++m) {
        const Filter& filter = state_.filters[m];
        measured.add(state_.weight(m, i), filter.axes[i].bias_rad_s,
                     state_.mean_scale(m, i) * (filter.bias_variance + white_variance));
      }
      innovations[i] = {
          .accepted = true,
          .residual_rad_s = (rates_rad_s[i] - state_.axes[i].reference_rad_s) - measured.mean(),
          .variance_rad2_s2 = measured.variance()};
    }
    return innovations;
  }
  [[nodiscard]] constexpr bool is_outlier_to_gate(const Innovations& innovations) const {
    const Gate& gate = coefficients_->gate;
    return gate.is_on() && std::any_of(innovations.begin(), innovations.end(),
                                       [&](const Innovation& one) { return gate.is_outlier(one); });
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
    const bool is_knock = is_outlier && state_.rejected < coefficients_->gate.longest_knock_ticks;
    count_rejected(is_knock, innovations);
    if (is_outlier && !is_knock) {  // it was a jump of this size
      const float largest = largest_square(innovations);
      inflate_variance(largest);
      for (Innovation& innovation : innovations) innovation.variance_rad2_s2 += largest;
    }
    return is_knock;
  }
  constexpr void count_rejected(bool is_knock, Innovations& innovations) {
    state_.rejected = is_knock ? static_cast<std::uint16_t>(state_.rejected + 1) : std::uint16_t{0};
    for (std::size_t i = 0; i < Axes; ++i) {
      const float square = innovations[i].residual_rad_s * innovations[i].residual_rad_s;
      innovations[i].accepted = !is_knock;
      innovations[i].rejected = is_knock;
      state_.axes[i].rejection_variance =
          is_knock ? coefficients_->gate.doubt(square, state_.rejected) : 0.0F;
    }
  }
  [[nodiscard]] static constexpr float largest_square(const Innovations& innovations) {
    float largest = 0.0F;
    for (const Innovation& one : innovations) {
      largest = std::max(largest, one.residual_rad_s * one.residual_rad_s);
    }
    return largest;
  }

  const Coefficients* coefficients_;
  State state_{};
};

/// The promise of the product page: six decades and the bias of three axes fit into 224 bytes, and
/// twelve hypotheses of them into a page of flash.
static_assert(sizeof(BankState<ModelShape{.decaying = 6}, 3>) <= 224);
static_assert(sizeof(BankState<ModelShape{.decaying = 6, .hypotheses = 12}, 3>) <= 4096);

}  // namespace zerorate::core
