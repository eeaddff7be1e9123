#include "host_tools/lib/experiments/paper/filter_cost.hpp"

#include <algorithm>
#include <chrono>

#include "host_tools/lib/experiments/paper/node_predictors.hpp"
#include "host_tools/lib/reference/full_state_filter.hpp"

namespace zerorate::experiments {
namespace {

// White noise too: without it every covariance but the newest is zero, and the paper's real-data
// case has it.
constexpr reference::FractionalNoise kNoise{
    .order = 0.5, .innovation_variance = 1.0, .white_variance = 10.0};

/// The quickest of a few repetitions: the least disturbed by what else the machine does.
template <class Work>
double quickest_s(int repetitions, Work work) {
  using Clock = std::chrono::steady_clock;
  double best = 0.0;
  for (int i = 0; i < repetitions; ++i) {
    const auto start = Clock::now();
    work();
    const double elapsed = std::chrono::duration<double>(Clock::now() - start).count();
    best = i == 0 ? elapsed : std::min(best, elapsed);
  }
  return best;
}

}  // namespace

std::vector<FilterCost> measure_filter_cost(const std::vector<std::size_t>& lengths) {
  constexpr int kRepetitions = 5;
  std::vector<FilterCost> costs;
  for (const std::size_t n : lengths) {
    auto full = reference::FullStateFilter::after_waiting(kNoise, n, n + kRepetitions);
    const auto decade =
        make_decade_kalman("decade", {.noise = kNoise}, {.calibration = n, .prediction = 1});
    const Eigen::MatrixXd samples = Eigen::MatrixXd::Ones(static_cast<Eigen::Index>(n), 1);
    costs.push_back(
        {.samples = n,
         .full_state_sample_s = quickest_s(kRepetitions,
                                           [&] {
                                             full.advance();
                                             full.observe(1.0);
                                           }),
         .decade_sample_s = quickest_s(kRepetitions, [&] { (void)decade->predict(samples); }) /
                            static_cast<double>(n)});
  }
  return costs;
}

}  // namespace zerorate::experiments
