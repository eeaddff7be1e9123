#include "host_tools/lib/calibrate/scale_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace zerorate::calibrate {
namespace {

using Pair = std::array<double, 2>;  ///< scale and asymmetry

/// Rows of the inverse of a symmetric matrix; without a second unknown, of its first element.
std::array<Pair, 2> inverse(const std::array<Pair, 2>& matrix, bool has_second) {
  if (!has_second) return {{{1.0 / matrix[0][0], 0.0}, {0.0, 0.0}}};
  const double determinant = matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0];
  return {{{matrix[1][1] / determinant, -matrix[0][1] / determinant},
           {-matrix[1][0] / determinant, matrix[0][0] / determinant}}};
}

/// Factors by which the excess of each turn enters scale and asymmetry.
std::vector<Pair> gains_of(std::span<const CountedTurn> turns, double mark_sigma_rad,
                           bool has_both_senses) {
  std::vector<Pair> weighted;
  std::array<Pair, 2> normal{};
  for (const CountedTurn& turn : turns) {
    const double true_rad = 2.0 * std::numbers::pi * turn.turns;
    const double marks_rad2 = 2.0 * mark_sigma_rad * mark_sigma_rad;
    const double weight = 1.0 / (turn.sigma_rad * turn.sigma_rad + marks_rad2);
    const Pair row{true_rad, std::abs(true_rad)};
    for (std::size_t i = 0; i < 2; ++i) {
      for (std::size_t j = 0; j < 2; ++j) normal[i][j] += weight * row[i] * row[j];
    }
    weighted.push_back({weight * row[0], weight * row[1]});
  }
  const auto covariance = inverse(normal, has_both_senses);
  for (Pair& row : weighted) {
    row = {covariance[0][0] * row[0] + covariance[0][1] * row[1],
           covariance[1][0] * row[0] + covariance[1][1] * row[1]};
  }
  return weighted;
}

RelativeError figure(std::span<const CountedTurn> turns, std::span<const Pair> gains,
                     std::size_t which, double mark_sigma_rad) {
  double value = 0.0;
  double variance = 0.0;
  double before = 0.0;  // gain of the turn that ended at the mark where this one begins
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const double gain = gains[i][which];
    const double mark = (before - gain) * mark_sigma_rad;
    const double own = gain * turns[i].sigma_rad;
    value += gain * (turns[i].measured_rad - 2.0 * std::numbers::pi * turns[i].turns);
    variance += mark * mark + own * own;
    before = gain;
  }
  const double last_mark = before * mark_sigma_rad;
  return {value, std::sqrt(variance + last_mark * last_mark)};
}

}  // namespace

ScaleFit fit_scale(std::span<const CountedTurn> turns, const FitSettings& settings) {
  const auto is_positive = [](const CountedTurn& turn) { return turn.turns > 0; };
  const bool has_both_senses =
      std::ranges::any_of(turns, is_positive) && !std::ranges::all_of(turns, is_positive);
  const std::vector<Pair> gains = gains_of(turns, settings.mark_sigma_rad, has_both_senses);
  ScaleFit fit{.scale = figure(turns, gains, 0, settings.mark_sigma_rad)};
  if (has_both_senses) {
    fit.asymmetry = figure(turns, gains, 1, settings.mark_sigma_rad);
  } else {
    fit.scale.sigma = std::hypot(fit.scale.sigma, settings.asymmetry_sigma);
  }
  return fit;
}

}  // namespace zerorate::calibrate
