/// @file
/// The overlapping Allan deviation of 10^7 samples at 100 averaging factors, against two plain
/// implementations of the definition in the same run.

#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <numeric>
#include <string_view>

#include "host_tools/lib/identify/allan_deviation.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace {

using zerorate::identify::allan_deviation;
using zerorate::identify::allan_variances;

/// `--short`, after the options of the library, takes a tenth of the samples: that is the test.
std::size_t samples = 10'000'000;

const std::vector<double>& recording() {
  static const std::vector<double> rate = [] {
    const std::vector<zerorate::simulate::Effect> effects{
        zerorate::simulate::WhiteNoise{1.0}, zerorate::simulate::FlickerNoise{0.3, 0.5, 0.0}};
    return zerorate::simulate::simulate(zerorate::simulate::Signal(samples, 1.0), effects,
                                        zerorate::random::RandomStream(20120416))
        .rate_rad_s;
  }();
  return rate;
}

const std::vector<std::size_t>& factors() {
  static const std::vector<std::size_t> grid = [] {
    std::vector<std::size_t> all = zerorate::identify::averaging_factors(samples, 17.5);
    all.resize(std::min(all.size(), std::size_t{100}));
    return all;
  }();
  return grid;
}

Eigen::ArrayXd angles() {
  const double mean =
      std::accumulate(recording().begin(), recording().end(), 0.0) / static_cast<double>(samples);
  Eigen::ArrayXd angle(static_cast<Eigen::Index>(samples) + 1);
  angle[0] = 0.0;
  for (Eigen::Index k = 0; k < angle.size() - 1; ++k) {
    angle[k + 1] = angle[k] + (recording()[static_cast<std::size_t>(k)] - mean);
  }
  return angle;
}

/// One whole-array operation after the other, as array languages evaluate the formula.
double by_whole_arrays(const Eigen::ArrayXd& angle, Eigen::Index m) {
  const Eigen::Index terms = angle.size() - 2 * m;
  const Eigen::ArrayXd doubled = 2.0 * angle.segment(m, terms);
  const Eigen::ArrayXd difference = angle.tail(terms) - doubled;
  const Eigen::ArrayXd second = difference + angle.head(terms);
  const Eigen::ArrayXd squares = second.square();
  return squares.mean() / (2.0 * static_cast<double>(m * m));
}

/// One pass over the recording, into which the compiler fuses the formula.
double by_one_pass(const Eigen::ArrayXd& angle, Eigen::Index m) {
  const Eigen::Index terms = angle.size() - 2 * m;
  return (angle.tail(terms) - 2.0 * angle.segment(m, terms) + angle.head(terms)).square().mean() /
         (2.0 * static_cast<double>(m * m));
}

template <double (*variance)(const Eigen::ArrayXd&, Eigen::Index)>
void plain(benchmark::State& state) {
  std::vector<double> variances(factors().size());
  for ([[maybe_unused]] auto _ : state) {
    const Eigen::ArrayXd angle = angles();
    for (std::size_t i = 0; i < factors().size(); ++i) {
      variances[i] = variance(angle, static_cast<Eigen::Index>(factors()[i]));
    }
    benchmark::DoNotOptimize(variances.data());
  }
  const std::vector<double> ours = allan_variances(recording(), factors());
  double worst = 0.0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    worst = std::max(worst, std::abs(variances[i] / ours[i] - 1.0));
  }
  state.counters["relative_difference"] = worst;
}

void tiled(benchmark::State& state) {
  (void)factors();
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(allan_variances(recording(), factors()));
  }
}

void tiled_with_intervals(benchmark::State& state) {
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(allan_deviation(recording(), 1.0, {.points_per_decade = 17.5}));
  }
}

BENCHMARK(plain<by_whole_arrays>)->Unit(benchmark::kMillisecond)->Name("whole_arrays");
BENCHMARK(plain<by_one_pass>)->Unit(benchmark::kMillisecond)->Name("one_pass");
BENCHMARK(tiled)->Unit(benchmark::kMillisecond);
BENCHMARK(tiled_with_intervals)->Unit(benchmark::kMillisecond);

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (argc > 1 && std::string_view(argv[1]) == "--short") samples /= 10;
  benchmark::RunSpecifiedBenchmarks();
}
