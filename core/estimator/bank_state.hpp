/// @file
/// Memory of a bank of Kalman filters.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/estimator/evidence.hpp"
#include "core/estimator/kalman_filter.hpp"
#include "core/estimator/mixture.hpp"
#include "core/estimator/prediction.hpp"

namespace zerorate::core {

/// Everything that KalmanBank remembers: plain data, may be stored and restored bit for bit.
template <ModelShape Shape, std::size_t Axes>
struct BankState {
  static constexpr std::size_t kHypotheses = Shape.hypotheses;
  static constexpr bool kLearns = kHypotheses > 1;
  static constexpr std::uint16_t kNotMeasured = 0xFFFF;
  using Filter = KalmanFilter<Shape, Axes>;
  /// Place of the evidence where there is one hypothesis.
  struct Certainty {
    constexpr bool operator==(const Certainty&) const = default;
  };
  using Evidence = std::conditional_t<kLearns, core::Evidence<kHypotheses, Axes>, Certainty>;

  struct Axis {
    /// First measurement. Filters are relative to it, so that a large bias does not use up the
    /// mantissa.
    float reference_rad_s = 0.0F;
    float rejection_variance = 0.0F;  ///< variance that rejected measurements add [rad2/s2]

    constexpr bool operator==(const Axis&) const = default;
  };

  std::uint16_t confirmations_left = kNotMeasured;  ///< measurements until the first is confirmed
  std::uint16_t rejected = 0;  ///< measurements since one was accepted (see Gate)
  std::array<Axis, Axes> axes{};
  std::array<Filter, kHypotheses> filters{};
  [[no_unique_address]] Evidence evidence;

  constexpr bool operator==(const BankState&) const = default;
  [[nodiscard]] constexpr bool is_measured() const { return confirmations_left != kNotMeasured; }
  /// Only later measurements can contradict a first one: until a second of them has agreed, it may
  /// have been anything.
  [[nodiscard]] constexpr bool is_confirmed() const { return confirmations_left == 0; }

  /// Posterior probability of a hypothesis on an axis; 1 where the model is known.
  [[nodiscard]] constexpr float weight(std::size_t m, std::size_t axis) const {
    if constexpr (kLearns) {
      return evidence.hypotheses[m][axis].weight;
    } else {
      return 1.0F;
    }
  }
  /// Mean of the factor that a hypothesis gives all variances of the model.
  [[nodiscard]] constexpr float mean_scale(std::size_t m, std::size_t axis) const {
    if constexpr (kLearns) {
      return evidence.mean_scale(m, axis);
    } else {
      return 1.0F;
    }
  }
  /// Biases at the newest measurement, with their variances.
  [[nodiscard]] constexpr std::array<Prediction, Axes> newest() const {
    std::array<Prediction, Axes> biases{};
    for (std::size_t i = 0; i < Axes; ++i) {
      Mixture<kLearns> mixture;
      for (std::size_t m = 0; m < kHypotheses; ++m) {
        mixture.add(weight(m, i), filters[m].axes[i].bias_rad_s,
                    mean_scale(m, i) * filters[m].bias_variance);
      }
      biases[i] = {axes[i].reference_rad_s + mixture.mean(),
                   mixture.variance() + axes[i].rejection_variance};
    }
    return biases;
  }
};

}  // namespace zerorate::core
