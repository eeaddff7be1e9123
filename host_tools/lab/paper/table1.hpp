/// @file
/// The paper's Table I, simulated half, with the node's filter and the paper's future work beside
/// it: the optimum, autoregressive models, intervals of the simple predictors, other orders d; and
/// what a sample costs in the paper's full-state filter and in the decade filter.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "host_tools/lab/paper/contest.hpp"
#include "host_tools/lab/reference/fractional_noise.hpp"

namespace zerorate::paper {

struct SimulationOptions {
  std::size_t runs = 1000;
  Lengths lengths;
  /// s_f = 2.5 brings the figures to the paper's scale (it does not state its own); ratios do not
  /// depend on it.
  reference::FractionalNoise noise{.order = 0.5, .innovation_variance = 6.25};
  int decades = 5;
  std::uint64_t seed = 1;
  unsigned threads = 0;  ///< 0: as many as the machine has
};

/// The sets that the experiment runs on.
[[nodiscard]] SetSource simulated_sets(const reference::FractionalNoise& noise, std::uint64_t seed);

/// Those who take part and do not need to know the bias; the calibration mean is the last.
[[nodiscard]] Predictors simulated_predictors(const SimulationOptions& options);

struct SimulatedStanding {
  Standing measured;
  Figure controlled_rsse_ratio;         ///< see controlled_rsse_ratio()
  std::optional<Expectation> expected;  ///< nothing for predictors that are not linear
};

/// Simulates `runs` sets by eq. 3 from nothing at the first sample (the paper's section V), and
/// lets all predictors run on them. The last standing is the calibration mean's, the yardstick.
/// About 20 s on two cores for 1000 runs of 1000 + 1000 samples.
[[nodiscard]] std::vector<SimulatedStanding> simulate_table1(const SimulationOptions& options,
                                                             const parallel::Progress& progress);

/// The decade filter against the optimum of the same order.
struct OrderStanding {
  double order;
  Standing decade_kalman;  ///< ratios are to the optimum
  Standing optimum;
  Expectation expected_decade_kalman;
  Expectation expected_optimum;
};

/// The future work "possibly with different choices of d" of the paper's section VI.
[[nodiscard]] std::vector<OrderStanding> compare_orders(const std::vector<double>& orders,
                                                        const SimulationOptions& options,
                                                        const parallel::Progress& progress);

struct FilterCost {
  std::size_t samples = 0;           ///< length n of the calibration so far
  double full_state_sample_s = 0.0;  ///< time that the full-state filter takes for sample n + 1
  double decade_sample_s = 0.0;      ///< time of the decade filter, a mean over n samples
};

/// Times both on this machine, one thread. The full-state filter at n starts from the covariance
/// that it has when it has waited for n samples, because running it there costs O(n^3).
[[nodiscard]] std::vector<FilterCost> measure_filter_cost(const std::vector<std::size_t>& lengths);

}  // namespace zerorate::paper
