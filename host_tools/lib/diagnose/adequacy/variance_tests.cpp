#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "host_tools/lib/diagnose/adequacy/adequacy.hpp"
#include "host_tools/lib/spectrum/transforms.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

/// Squares summed over equal stretches: are they as alike as chance makes them?
void test_stretches(const StandardisedResidual& residual, std::size_t stretches, Tests& tests) {
  const std::vector<double>& u = residual.values;
  const std::size_t length = u.size() / stretches;
  if (length < 4) return;
  const auto freedom = static_cast<double>(length);
  double sum = 0.0;
  double most = 0.0;
  std::size_t at = 0;
  for (std::size_t b = 0; b < stretches; ++b) {
    double squares = 0.0;
    for (std::size_t k = b * length; k < (b + 1) * length; ++k) squares += u[k] * u[k];
    const double z = statistics::normal_of_chi_squared(squares, freedom);
    sum += z * z;
    if (std::abs(z) > most) {
      most = std::abs(z);
      at = b;
    }
  }
  const EvenSeries& series = residual.hypothesis->data().series();
  tests.push_back({fmt::format("the strength of the noise varies over time, from one {} s to "
                               "the next",
                               units::in_figures(freedom * series.period_s)),
                   statistics::log_chi_squared_tail(sum, static_cast<double>(stretches))});
  tests.push_back({fmt::format("the strength of the noise is another near {} s",
                               units::in_figures(series.time_s(at * length + length / 2), 4)),
                   statistics::log_of_smallest(statistics::log_normal_tails(most),
                                               static_cast<double>(stretches))});
}

/// The strongest line in the spectrum of the squares.
Test strongest_period(const StandardisedResidual& residual) {
  const std::size_t n = residual.values.size();
  std::vector<double> excess(n);
  double mean = 0.0;
  for (const double u : residual.values) mean += u * u / static_cast<double>(n);
  double squares = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    // Bounded, so that a single wild value is left to the tests of the tails.
    excess[k] = std::min(residual.values[k] * residual.values[k], 9.0) - mean;
    squares += excess[k] * excess[k];
  }
  const spectrum::RealFft& fft = residual.hypothesis->data().transform().fourier();
  std::vector<std::complex<double>> bins(fft.bins());
  fft.forward(excess, bins);
  double most = 0.0;
  std::size_t at = 1;
  for (std::size_t j = 1; j + 1 < bins.size(); ++j) {
    if (std::norm(bins[j]) <= most) continue;
    most = std::norm(bins[j]);
    at = j;
  }
  const double period_s = residual.hypothesis->data().span_s() / static_cast<double>(at);
  return {
      fmt::format("the strength of the noise has a period of {} s", units::in_figures(period_s, 4)),
      statistics::log_of_smallest(-most / squares, 0.5 * static_cast<double>(n))};
}

/// Large values follow large values within so many.
Test clusters(const StandardisedResidual& residual, std::size_t lags) {
  // Bounded, so that a pair of wild values does not decide: E min(u^2, 9) = 0.9950, Var = 1.901.
  constexpr double kMost = 9.0;
  constexpr double kMean = 0.9950;
  constexpr double kVariance = 1.901;
  const std::vector<double>& u = residual.values;
  std::vector<double> excess(u.size());
  for (std::size_t k = 0; k < u.size(); ++k) excess[k] = std::min(u[k] * u[k], kMost) - kMean;
  double sum = 0.0;
  double recent = 0.0;
  for (std::size_t k = 0; k < u.size(); ++k) {
    sum += excess[k] * recent;
    recent += excess[k] - (k >= lags ? excess[k - lags] : 0.0);
  }
  const double variance = kVariance * kVariance * static_cast<double>(lags * u.size());
  return {"large deviations come in clusters",
          statistics::log_normal_tails(sum / std::sqrt(variance))};
}

}  // namespace

Tests test_variance(const StandardisedResidual& residual) {
  Tests tests;
  for (const std::size_t stretches : {8U, 32U, 128U, 512U})
    test_stretches(residual, stretches, tests);
  tests.push_back(strongest_period(residual));
  for (const std::size_t lags : {4U, 32U, 200U}) tests.push_back(clusters(residual, lags));
  return tests;
}

}  // namespace zerorate::diagnose
