/// @file
/// Share of the drifts of a filter that is forgotten over a span of ticks.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/compile_time.hpp"
#include "core/base/complex.hpp"
#include "core/base/symmetric_matrix.hpp"
#include "core/noise/model_shape.hpp"

namespace zerorate::core {

/// The block-diagonal matrix F of eq. 7 (docs/design/kalman-predictor.md): 1 - alpha for a decaying
/// mode, 1 - alpha (complex) for the two drifts of a rotating one, 1 for the coefficients of
/// the inputs. Slow modes forget a small share, which is subtracted: no factor near one is formed.
template <ModelShape Shape>
class Forgetting {
 public:
  static constexpr std::size_t kDecaying = Shape.decaying;
  static constexpr std::size_t kRotating = Shape.rotating;
  static constexpr std::size_t kDrifts = kDecaying + 2 * kRotating + Shape.inputs;
  using Drifts = std::array<float, kDrifts>;
  using Covariance = SymmetricMatrix<kDrifts>;

  constexpr Forgetting(const std::array<float, kDecaying>& decaying,
                       const std::array<Complex, kRotating>& rotating)
      : decaying_(decaying), rotating_(rotating) {
    for (std::size_t i = 0; i < kDecaying; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        pairs_(i, j) = decaying[i] + decaying[j] - decaying[i] * decaying[j];
      }
    }
  }

  /// w = F w.
  constexpr void apply(Drifts& w) const {
    ZERORATE_UNROLLED for (std::size_t i = 0; i < kDecaying; ++i) w[i] -= decaying_[i] * w[i];
    for (std::size_t i = 0; i < kRotating; ++i) turn(i, w[first(i)], w[first(i) + 1]);
  }

  /// W = F W F'.
  constexpr void apply(Covariance& w) const {
    ZERORATE_UNROLLED for (std::size_t i = 0; i < kDecaying; ++i) {
      ZERORATE_UNROLLED for (std::size_t j = 0; j <= i; ++j) w(i, j) -= pairs_(i, j) * w(i, j);
    }
    if constexpr (kOthers > 0) {
      for (std::size_t j = 0; j < kDecaying; ++j) {
        for (std::size_t i = kDecaying; i < kDrifts; ++i) w(i, j) -= decaying_[j] * w(i, j);
        for (std::size_t i = 0; i < kRotating; ++i) turn(i, w(first(i), j), w(first(i) + 1, j));
      }
      apply_to_others(w);
    }
  }

 private:
  static constexpr std::size_t kOthers = kDrifts - kDecaying;
  static constexpr std::size_t first(std::size_t i) { return kDecaying + 2 * i; }

  constexpr void turn(std::size_t i, float& re, float& im) const {
    const Complex z{re, im};
    const Complex forgotten = rotating_[i] * z;
    re -= forgotten.re;
    im -= forgotten.im;
  }

  /// Part of the covariance without decaying modes: columns, then rows.
  constexpr void apply_to_others(Covariance& w) const {
    std::array<std::array<float, kOthers>, kOthers> full{};
    for (std::size_t i = 0; i < kOthers; ++i) {
      for (std::size_t j = 0; j < kOthers; ++j) full[i][j] = w(kDecaying + i, kDecaying + j);
      for (std::size_t k = 0; k < kRotating; ++k) turn(k, full[i][2 * k], full[i][2 * k + 1]);
    }
    for (std::size_t j = 0; j < kOthers; ++j) {
      for (std::size_t k = 0; k < kRotating; ++k) turn(k, full[2 * k][j], full[2 * k + 1][j]);
      for (std::size_t i = j; i < kOthers; ++i) w(kDecaying + i, kDecaying + j) = full[i][j];
    }
  }

  std::array<float, kDecaying> decaying_;
  std::array<Complex, kRotating> rotating_;
  SymmetricMatrix<kDecaying> pairs_;  ///< 1 - (1 - alpha_i)(1 - alpha_j)
};

}  // namespace zerorate::core
