/// @file
/// Minimum of a function of one variable.
#pragma once

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <limits>

namespace zerorate::identify {

struct ScalarMinimum {
  double at;
  double value;  ///< not finite if no value of the scan is
};

/// Lowest point of a function that is smooth between the points of a scan: the scan, then Brent's
/// method around its lowest point.
/// @param steps of the scan, from `low` to `high`
/// @param bits of precision that Brent's method stops at
template <class Function>
[[nodiscard]] ScalarMinimum minimise(const Function& function, double low, double high, int steps,
                                     int bits) {
  const double step = (high - low) / steps;
  ScalarMinimum best{low, std::numeric_limits<double>::infinity()};
  for (int i = 0; i <= steps; ++i) {
    const double at = low + step * i;
    const double value = function(at);
    if (value < best.value) best = {at, value};
  }
  const auto [at, value] = boost::math::tools::brent_find_minima(
      function, std::max(low, best.at - step), std::min(high, best.at + step), bits);
  return value < best.value ? ScalarMinimum{at, value} : best;
}

}  // namespace zerorate::identify
