#include "host_tools/lab/paper/table1.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "host_tools/lab/paper/predictors.hpp"
#include "host_tools/lab/reference/full_state_filter.hpp"
#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/spectrum/fractional_filter.hpp"

namespace zerorate::paper {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using reference::FractionalNoise;

DecadeNoise decade_noise(const SimulationOptions& options, core::Start start) {
  return {.noise = options.noise, .decades = options.decades, .start = start};
}

/// Expectation of each predictor that is linear.
std::vector<std::optional<Expectation>> expect_all(const Predictors& predictors,
                                                   const SimulationOptions& options,
                                                   const parallel::Progress& progress) {
  std::vector<std::optional<Expectation>> expected(predictors.size());
  const auto work = [&](std::size_t i) {
    if (predictors[i]->is_linear()) {
      expected[i] = expect(*predictors[i], options.noise, options.lengths);
    }
  };
  parallel::for_each(predictors.size(), options.threads, work, progress);
  return expected;
}

/// The share of a progress that one part of the work takes.
parallel::Progress part_of(const parallel::Progress& progress, double from, double to) {
  if (!progress) return {};
  return [&progress, from, to](double share) { progress(from + (to - from) * share); };
}

}  // namespace

SetSource simulated_sets(const FractionalNoise& noise, std::uint64_t seed) {
  const random::RandomStream stream{seed};  // each set has a substream of its own
  return [noise, stream](std::size_t first, MatrixXd& block) {
    const auto samples = static_cast<std::size_t>(block.rows());
    std::vector<double> white(samples);
    for (Index run = 0; run < block.cols(); ++run) {
      const auto own = stream.substream(first + static_cast<std::size_t>(run));
      const auto driving = own.substream("flicker_noise");
      const std::span<double> values{block.col(run).data(), samples};
      spectrum::integrate_fractionally(
          noise.order,
          [&](std::ptrdiff_t begin, std::span<double> part) { driving.fill_normal(begin, part); },
          0, values);
      own.substream("white_noise").fill_normal(0, white);
      for (std::size_t k = 0; k < samples; ++k) {
        values[k] = std::sqrt(noise.innovation_variance) * values[k] +
                    std::sqrt(noise.white_variance) * white[k];
      }
    }
  };
}

Predictors simulated_predictors(const SimulationOptions& options) {
  const auto& noise = options.noise;
  const auto& lengths = options.lengths;
  const DecadeNoise zero = decade_noise(options, core::Start::zero);
  const DecadeNoise stationary = decade_noise(options, core::Start::stationary);
  Predictors predictors;
  predictors.push_back(make_full_state("full-state Kalman (paper)", noise, lengths));
  predictors.push_back(
      make_optimum("optimum, b unknown", noise, reference::Bias::diffuse, lengths));
  predictors.push_back(make_decade_kalman("decade Kalman, zero start", zero, lengths));
  predictors.push_back(make_decade_kalman("decade Kalman, stationary start", stationary, lengths));
  predictors.push_back(make_autoregression("AR(4), least squares", AutoregressionFit::least_squares,
                                           4, noise, lengths));
  predictors.push_back(
      make_autoregression("AR(120), Burg", AutoregressionFit::burg, 120, noise, lengths));
  predictors.push_back(make_moving_average("moving average", zero, lengths));
  predictors.push_back(make_calibration_mean("calibration mean", zero, lengths));
  return predictors;
}

std::vector<SimulatedStanding> simulate_table1(const SimulationOptions& options,
                                               const parallel::Progress& progress) {
  Predictors predictors = simulated_predictors(options);
  predictors.insert(predictors.begin() + 2, make_optimum("optimum, b known", options.noise,
                                                         reference::Bias::known, options.lengths));
  const auto expected = expect_all(predictors, options, part_of(progress, 0.1, 0.4));
  const auto mean_square = [&expected](std::size_t i) {
    return expected[i] ? std::optional(expected[i]->mean_squared_rsse()) : std::nullopt;
  };
  const Scores scores = run_contest(predictors, options.lengths, options.runs,
                                    simulated_sets(options.noise, options.seed), options.threads,
                                    part_of(progress, 0.4, 1.0));
  const double yardstick = expected.back().value().mean_squared_rsse();
  std::vector<SimulatedStanding> standings;
  for (std::size_t i = 0; i < predictors.size(); ++i) {
    standings.push_back({make_standing(predictors[i]->name(), scores[i], scores.back()),
                         controlled_rsse_ratio(scores[i], mean_square(i), scores.back(), yardstick),
                         expected[i]});
  }
  return standings;
}

std::vector<OrderStanding> compare_orders(const std::vector<double>& orders,
                                          const SimulationOptions& options,
                                          const parallel::Progress& progress) {
  std::vector<OrderStanding> standings;
  for (const double order : orders) {
    SimulationOptions own = options;
    own.noise.order = order;
    Predictors predictors;
    predictors.push_back(make_decade_kalman("decade Kalman, zero start",
                                            decade_noise(own, core::Start::zero), own.lengths));
    predictors.push_back(
        make_optimum("optimum, b unknown", own.noise, reference::Bias::diffuse, own.lengths));
    const auto position = static_cast<double>(standings.size());
    const auto count = static_cast<double>(orders.size());
    const Scores scores =
        run_contest(predictors, own.lengths, own.runs, simulated_sets(own.noise, own.seed),
                    own.threads, part_of(progress, position / count, (position + 1.0) / count));
    const auto expected = expect_all(predictors, own, {});
    standings.push_back({order, make_standing(predictors[0]->name(), scores[0], scores[1]),
                         make_standing(predictors[1]->name(), scores[1], scores[1]),
                         expected[0].value(), expected[1].value()});
  }
  return standings;
}

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

}  // namespace zerorate::paper
