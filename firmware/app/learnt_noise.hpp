/// @file
/// Noise model of a sensor as its node has learnt it.
#pragma once

#include <cstddef>

#include "core/base/numeric.hpp"

namespace zerorate::app {

/// Figure of a noise model with its standard deviation.
struct LearntFigure {
  float value = 0.0F;
  float sigma = 0.0F;

  constexpr bool operator==(const LearntFigure&) const = default;
};

/// Figures of an axis: posterior means over the hypotheses of its filter. All zero where nothing is
/// learnt.
struct LearntNoise {
  LearntFigure order;                             ///< d
  LearntFigure bias_instability_rad_s;            ///< B
  LearntFigure angle_random_walk_rad_per_sqrt_s;  ///< N
  float stops = 0.0F;  ///< stops behind the figures, older ones counted in part

  constexpr bool operator==(const LearntNoise&) const = default;
};

/// Mean and standard deviation of a figure of the hypotheses.
/// @param relative_variance of the figure where the hypothesis is given
/// @tparam Figure of a hypothesis and its scale
template <class Bank, class Figure>
[[nodiscard]] constexpr LearntFigure learnt_figure(const Bank& bank, std::size_t axis,
                                                   float relative_variance, Figure figure) {
  const float mean = bank.expected(axis, 0.0F, figure);
  const float variance = bank.expected(axis, 0.0F, [&](const auto& one, float scale) {
    const float given = figure(one, scale);
    const float apart = given - mean;
    return apart * apart + relative_variance * given * given;
  });
  return {.value = mean, .sigma = core::square_root(variance)};
}

/// Noise of an axis by the hypotheses of its filter. Cost: 4 square roots a hypothesis.
template <class Bank>
[[nodiscard]] constexpr LearntNoise learnt_noise(const Bank& bank, std::size_t axis, float stops) {
  const float of_root = bank.root_scale_variance();
  return {
      .order = learnt_figure(bank, axis, 0.0F, [](const auto& one, float) { return one.order; }),
      .bias_instability_rad_s = learnt_figure(bank, axis, of_root,
                                              [](const auto& one, float scale) {
                                                return core::square_root(scale) *
                                                       one.bias_instability_rad_s;
                                              }),
      .angle_random_walk_rad_per_sqrt_s =
          learnt_figure(bank, axis, of_root,
                        [](const auto& one, float scale) {
                          return core::square_root(scale) * one.angle_random_walk_rad_per_sqrt_s;
                        }),
      .stops = stops};
}

}  // namespace zerorate::app
