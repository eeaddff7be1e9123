/// @file
/// Forecasts of a bank of Kalman filters.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/estimator/bank_state.hpp"
#include "core/estimator/kalman_coefficients.hpp"
#include "core/estimator/mixture.hpp"
#include "core/estimator/prediction.hpp"

namespace zerorate::core {

/// Spans from the time of each filter of a bank to one later time. While a measurement is being
/// learnt hypothesis by hypothesis, the first filters stand at its tick and the others at the tick
/// of the measurement before.
template <class Transition>
struct BankLead {
  const Transition& others;
  const Transition& advanced;
  std::size_t advanced_filters = 0;  ///< number of filters at the later tick

  [[nodiscard]] constexpr const Transition& of(std::size_t m) const {
    return m < advanced_filters ? advanced : others;
  }
};

/// Predictions of the filters of a bank: mean and variance of the mixture of their forecasts.
/// One forecast a call of add() lets a board spread the work.
///
/// Cost of a hypothesis and three axes at six decaying modes: 100 floating-point operations for the
/// bias, 200 for its integral.
template <ModelShape Shape, std::size_t Axes>
class BankForecast {
 public:
  using Coefficients = KalmanCoefficients<Shape>;
  using Transition = typename Coefficients::Transition;
  using Drifts = typename Coefficients::Drifts;
  using State = BankState<Shape, Axes>;
  using Filter = typename State::Filter;
  using Mixtures = std::array<Mixture<State::kLearns>, Axes>;
  using Lead = BankLead<Transition>;

  constexpr BankForecast(const Coefficients& coefficients, const State& state)
      : coefficients_(coefficients), state_(state) {}

  /// Filters that are in use; a bank with room for hypotheses runs one where the model is known.
  [[nodiscard]] constexpr std::size_t count() const {
    return State::kLearns ? coefficients_.used_hypotheses() : 1;
  }
  [[nodiscard]] constexpr bool is_learning() const {
    return State::kLearns && coefficients_.hypotheses->count > 0;
  }
  /// Bias after the lead; before the first measurement, 0.
  [[nodiscard]] constexpr float bias_rad_s(const Lead& lead, std::size_t axis) const {
    if (!state_.is_measured()) return 0.0F;
    float bias_rad_s = 0.0F;
    for (std::size_t m = 0; m < count(); ++m) {
      const Filter& filter = state_.filters[m];
      bias_rad_s +=
          state_.weight(m, axis) *
          (filter.axes[axis].bias_rad_s + filter.moved(Coefficients::movement(lead.of(m)), axis));
    }
    return state_.axes[axis].reference_rad_s + bias_rad_s;
  }

  /// Adds the forecast of hypothesis m to the mixture.
  constexpr void add(Mixtures& biases, std::size_t m, const Transition& lead) const {
    const Filter& filter = state_.filters[m];
    const Drifts g = Coefficients::movement(lead);
    const float variance = filter.bias_variance + filter.moved_variance(1.0F, g) +
                           lead.noise(coefficients_.strength(m));
    for (std::size_t i = 0; i < Axes; ++i) {
      const float scale = state_.mean_scale(m, i);
      biases[i].add(state_.weight(m, i), filter.axes[i].bias_rad_s + filter.moved(g, i),
                    scale * variance + filter.unknown_variance(coefficients_, lead, i, scale));
    }
  }
  /// Answers of a mixture that all hypotheses were added to.
  [[nodiscard]] constexpr std::array<Prediction, Axes> of(const Mixtures& biases) const {
    std::array<Prediction, Axes> predictions{};
    if (!state_.is_measured()) return predictions;
    for (std::size_t i = 0; i < Axes; ++i) {
      predictions[i] = {state_.axes[i].reference_rad_s + biases[i].mean(),
                        biases[i].variance() + state_.axes[i].rejection_variance};
    }
    return predictions;
  }
  [[nodiscard]] constexpr std::array<Prediction, Axes> predict(const Lead& lead) const {
    Mixtures biases{};
    for (std::size_t m = 0; m < count() && state_.is_measured(); ++m) add(biases, m, lead.of(m));
    return of(biases);
  }

  /// Adds the integral of hypothesis m over `drive`, which begins after the lead, to the mixture.
  /// With L the lead and D ticks of drive,
  ///
  ///     sum of the bias = D s + h'w + D n_s + G'n_w + n_D,   h = D g_L + F_L' G,
  ///
  /// so that the filter need not be copied and advanced (docs/design/kalman-predictor.md, eq. 14).
  constexpr void add_integral(Mixtures& sums, std::size_t m, const Transition& lead,
                              const Transition& drive) const {
    const Filter& filter = state_.filters[m];
    const auto ticks = static_cast<float>(drive.ticks);
    const Drifts from_drive = coefficients_.movement_of_sum(drive);
    const auto noise = coefficients_.noise_of(lead, m);
    Drifts h = Coefficients::forgotten_transposed(lead, from_drive);
    const Drifts g = Coefficients::movement(lead);
    float variance = drive.sum_variance(coefficients_.strength(m)) + ticks * ticks * noise.bias;
    for (std::size_t i = 0; i < Coefficients::kDrifts; ++i) {
      h[i] += ticks * g[i];
      variance += from_drive[i] * (2.0F * ticks * noise.cross[i] + from_drive[i] * noise.drift[i]);
    }
    variance += filter.moved_variance(ticks, h);
    const float constant = filter.bias_variance + largest_unknown_variance(m, lead);
    for (std::size_t i = 0; i < Axes; ++i) {
      const float scale = state_.mean_scale(m, i);
      sums[i].add(state_.weight(m, i), ticks * filter.axes[i].bias_rad_s + filter.moved(h, i),
                  scale * variance + ticks * ticks *
                                         (scale * constant +
                                          filter.unknown_variance(coefficients_, drive, i, scale)));
    }
  }
  /// Answers of a mixture that the integrals of all hypotheses were added to.
  /// @param drive_ticks D
  [[nodiscard]] constexpr std::array<HeadingPrediction, Axes> integrals_of(
      const Mixtures& sums, std::uint32_t drive_ticks) const {
    std::array<HeadingPrediction, Axes> headings{};
    if (!state_.is_measured()) return headings;
    const auto ticks = static_cast<float>(drive_ticks);
    const float tick_s = coefficients_.tick_s;
    for (std::size_t i = 0; i < Axes; ++i) {
      const typename State::Axis& x = state_.axes[i];
      const float variance = sums[i].variance() + ticks * ticks * x.rejection_variance;
      headings[i] = {(ticks * x.reference_rad_s + sums[i].mean()) * tick_s,
                     variance * tick_s * tick_s};
    }
    return headings;
  }
  /// Integrals of the biases over `drive`, which begins after the lead.
  [[nodiscard]] constexpr std::array<HeadingPrediction, Axes> predict_heading(
      const Lead& lead, const Transition& drive) const {
    Mixtures sums{};
    for (std::size_t m = 0; m < count() && state_.is_measured(); ++m) {
      add_integral(sums, m, lead.of(m), drive);
    }
    return integrals_of(sums, drive.ticks);
  }

  /// Unknown variance of the axis with the largest slope, so that no interval is too narrow.
  [[nodiscard]] constexpr float largest_unknown_variance(std::size_t m,
                                                         const Transition& span) const {
    float largest = 0.0F;
    if constexpr (Shape.inputs > 0) {
      for (std::size_t i = 0; i < Axes; ++i) {
        const float scale = state_.mean_scale(m, i);
        largest = std::max(
            largest, state_.filters[m].unknown_variance(coefficients_, span, i, scale) / scale);
      }
    }
    return largest;
  }

 private:
  const Coefficients& coefficients_;
  const State& state_;
};

}  // namespace zerorate::core
