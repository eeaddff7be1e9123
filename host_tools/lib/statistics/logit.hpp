/// @file
/// The logit of a share, and back.
#pragma once

#include <cmath>

namespace zerorate::statistics {

/// log(p / (1 - p)), p in (0, 1).
[[nodiscard]] inline double logit(double share) {
  return std::log(share / (1.0 - share));
}

/// Share whose logit is given.
[[nodiscard]] inline double share_of_logit(double logit) {
  return 1.0 / (1.0 + std::exp(-logit));
}

}  // namespace zerorate::statistics
