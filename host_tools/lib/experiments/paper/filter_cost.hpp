/// @file
/// Cost of a sample in the paper's full-state filter and in the decade filter.
#pragma once

#include <cstddef>
#include <vector>

namespace zerorate::experiments {

struct FilterCost {
  std::size_t samples = 0;           ///< length n of the calibration so far
  double full_state_sample_s = 0.0;  ///< time that the full-state filter takes for sample n + 1
  double decade_sample_s = 0.0;      ///< the same of the decade filter: a mean over n samples
};

/// Times both on this machine, one thread. The full-state filter at n starts from the covariance
/// that it has when it has waited for n samples, because running it there costs O(n^3).
[[nodiscard]] std::vector<FilterCost> measure_filter_cost(const std::vector<std::size_t>& lengths);

}  // namespace zerorate::experiments
