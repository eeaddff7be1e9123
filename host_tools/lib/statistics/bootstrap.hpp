/// @file
/// Intervals of any statistic by drawing its data again.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::statistics {

/// A figure and its 95 % interval by the bootstrap; NaN where there was nothing to measure.
struct BootstrapFigure {
  double value = std::numeric_limits<double>::quiet_NaN();
  double lo = std::numeric_limits<double>::quiet_NaN();
  double hi = std::numeric_limits<double>::quiet_NaN();
};

/// Computed from the data with these indices, which may repeat.
using Statistic = std::function<double(const std::vector<std::size_t>& indices)>;

struct BootstrapParams {
  std::size_t draws = 2000;
  /// Neighbours that depend on each other are drawn together, so many at a time, around the end
  /// (Politis and Romano 1992); 1: all are independent.
  std::size_t block = 1;
};

/// The statistic of all indices below `size`, and its interval over draws with replacement: between
/// the order statistics that leave 2.5 % at either end. No figure (NaN) where the statistic is NaN.
[[nodiscard]] BootstrapFigure bootstrap(std::size_t size, const Statistic& statistic,
                                        const random::RandomStream& stream,
                                        const BootstrapParams& params = {});

}  // namespace zerorate::statistics
