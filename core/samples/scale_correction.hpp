/// @file
/// Known errors of the scale factors of a gyro, taken off its samples.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/units.hpp"

namespace zerorate::core {

/// Correction of the measured rates, before anything is learnt or published. Off by default: a
/// product with 1 keeps the bits of a rate.
///
/// Cost of a sample: three products.
struct ScaleCorrection {
  using Rates = std::array<AngularRate, 3>;

  std::array<float, 3> factor{1.0F, 1.0F, 1.0F};  ///< factor of the rates of x, y and z

  constexpr bool operator==(const ScaleCorrection&) const = default;
  /// Factor of an axis.
  /// @param error relative error of its scale factor: 0.01 where a turn by 100 deg is measured as
  /// 101 deg
  [[nodiscard]] static constexpr float factor_of(float error) { return 1.0F / (1.0F + error); }
  [[nodiscard]] constexpr bool is_on() const { return *this != ScaleCorrection{}; }
  [[nodiscard]] constexpr AngularRate corrected(AngularRate measured, std::size_t axis) const {
    return measured * factor[axis];
  }
  /// Not inlined: a board counts its stack.
  [[gnu::noinline]] [[nodiscard]] constexpr Rates corrected(const Rates& measured) const {
    Rates rates{};
    for (std::size_t i = 0; i < rates.size(); ++i) rates[i] = corrected(measured[i], i);
    return rates;
  }
};

}  // namespace zerorate::core
