/// @file
/// The standard normal distribution.
#pragma once

#include <cmath>
#include <numbers>

namespace zerorate::campaign {

/// The probability of more than z.
inline double normal_tail(double z) {
  return 0.5 * std::erfc(z / std::numbers::sqrt2);
}

inline double normal_density(double z) {
  return std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
}

}  // namespace zerorate::campaign
