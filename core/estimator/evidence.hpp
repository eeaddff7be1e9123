/// @file
/// Evidence for and against the hypotheses of a filter, and the scale of each.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/base/numeric.hpp"

namespace zerorate::core {

/// Weights and scales of hypotheses, axis by axis (docs/design/learning.md, sections 2 and 3).
///
/// A hypothesis predicts a measurement with the variance S in units of an unknown scale. The scale
/// is inverse-gamma with the shape a and the value s = rate / a, so that the prediction is
/// Student's t with 2 a degrees of freedom and the squared scale s S. A residual e moves the
/// evidence l of its axis, a logarithm, and the scale:
///
///     l += -1/2 log(s S) - (a + 1/2) log(1 + e^2 / (2 a s S)),
///     s += (e^2 / S - s) / (2 a + 1),   a += 1/2.
///
/// Before each measurement a and l fade. The axes of a chip are alike, but not the same: an axis
/// weighs a hypothesis by its prior, its own evidence, and a fifth of the other axes'.
///
/// Plain data: may be stored and restored bit for bit. Cost of a measurement of M hypotheses on A
/// axes: 2 M A logarithms, M A exponentials and 2 M A divisions.
template <std::size_t Hypotheses, std::size_t Axes>
struct Evidence {
  struct OfAxis {
    float log_evidence = 0.0F;  ///< l, less that of the likeliest hypothesis
    float weight = 0.0F;        ///< posterior probability; 0 of hypotheses that are not used
    float scale = 1.0F;         ///< s

    constexpr bool operator==(const OfAxis&) const = default;
  };
  static constexpr float kPriorShape = 2.0F;  ///< a factor of three either way
  /// Share of the other axes' evidence: measured, docs/reference/learning.md.
  static constexpr float kPooling = 0.2F;

  float shape = kPriorShape;  ///< a: half the number of measurements that the scales rest on
  std::array<std::array<OfAxis, Axes>, Hypotheses> hypotheses{};

  constexpr bool operator==(const Evidence&) const = default;

  /// Begins with the prior of these hypotheses, all at the same scale. Call weigh() for each axis.
  /// Without hypotheses the first one is the model itself, and certain.
  template <class Given>
  constexpr void start(const Given& given, float scale) {
    shape = kPriorShape;
    for (std::size_t m = 0; m < given.count; ++m) {
      for (OfAxis& one : hypotheses[m]) {
        one.log_evidence = given.all[m].first_log_evidence();
        one.scale = scale;
      }
    }
    if (given.count > 0) return subtract_largest(given);
    for (OfAxis& one : hypotheses[0]) one = {.weight = 1.0F, .scale = (shape - 1.0F) / shape};
  }

  /// The unit of the scales of hypothesis m is larger by this factor than was assumed.
  constexpr void rescale(std::size_t m, float factor) {
    for (OfAxis& one : hypotheses[m]) one.scale *= factor;
  }

  /// A measurement that hypothesis m predicted with the variance S and missed by e.
  /// @param kept share of the older evidence that counts
  constexpr void observe(std::size_t m, std::size_t axis, float variance, float residual,
                         float kept) {
    OfAxis& one = hypotheses[m][axis];
    const float a = faded_shape(kept);
    const float scaled = one.scale * variance;
    const float squared = residual * residual / scaled;
    one.log_evidence = kept * one.log_evidence - 0.5F * log_of(scaled) -
                       (a + 0.5F) * log_of(1.0F + squared / (a + a));
    one.scale += one.scale * (squared - 1.0F) / (a + a + 1.0F);
  }
  /// All hypotheses have observed the measurement. Call weigh() for each axis next.
  template <class Given>
  constexpr void conclude(const Given& given) {
    shape = faded_shape(given.kept) + 0.5F;
    subtract_largest(given);
  }
  /// Probabilities of the hypotheses on an axis, from the evidence.
  template <class Given>
  constexpr void weigh(const Given& given, std::size_t axis) {
    float largest = log_posterior(given, 0, axis);
    for (std::size_t m = 0; m < given.count; ++m) {
      hypotheses[m][axis].weight = log_posterior(given, m, axis);
      largest = std::max(largest, hypotheses[m][axis].weight);
    }
    float sum = 0.0F;
    for (std::size_t m = 0; m < given.count; ++m) {
      float& weight = hypotheses[m][axis].weight;
      weight = 1.0F - one_minus_exp_neg(largest - weight);
      sum += weight;
    }
    for (std::size_t m = 0; m < given.count; ++m) hypotheses[m][axis].weight /= sum;
  }

  /// Mean of the scale: a / (a - 1) times s.
  [[nodiscard]] constexpr float mean_scale(std::size_t m, std::size_t axis) const {
    return hypotheses[m][axis].scale * shape / (shape - 1.0F);
  }
  /// Variance of the root of a scale over its square, by the spread of its logarithm: the
  /// trigamma function of a is 1 / (a - 1/2) within 4 %.
  [[nodiscard]] constexpr float root_variance() const { return 0.25F / (shape - 0.5F); }

 private:
  static constexpr float log_of(float x) { return natural_log(std::max(x, 1e-37F)); }

  [[nodiscard]] constexpr float faded_shape(float kept) const {
    return std::max(kept * shape, kPriorShape);
  }

  /// Makes the largest evidence of each axis 0.
  template <class Given>
  constexpr void subtract_largest(const Given& given) {
    for (std::size_t i = 0; i < Axes; ++i) {
      float largest = hypotheses[0][i].log_evidence;
      for (std::size_t m = 1; m < given.count; ++m) {
        largest = std::max(largest, hypotheses[m][i].log_evidence);
      }
      for (std::size_t m = 0; m < given.count; ++m) hypotheses[m][i].log_evidence -= largest;
    }
  }
  /// Logarithm of the weight, less a constant.
  template <class Given>
  [[nodiscard]] constexpr float log_posterior(const Given& given, std::size_t m,
                                              std::size_t axis) const {
    float of_all = 0.0F;
    for (const OfAxis& one : hypotheses[m]) of_all += one.log_evidence;
    const float own = hypotheses[m][axis].log_evidence;
    return given.all[m].log_prior + own + kPooling * (of_all - own);
  }
};

}  // namespace zerorate::core
