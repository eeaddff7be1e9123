#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host_tools/lib/diagnose/adequacy/adequacy.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

struct Moments {
  double size = 0.0;
  double skewness = 0.0;
  double kurtosis = 0.0;
};

Moments moments_of(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  double mean = 0.0;
  for (const double v : values) mean += v / n;
  double second = 0.0;
  double third = 0.0;
  double fourth = 0.0;
  for (const double v : values) {
    const double d = v - mean;
    second += d * d / n;
    third += d * d * d / n;
    fourth += d * d * d * d / n;
  }
  return {n, third / std::pow(second, 1.5), fourth / (second * second)};
}

/// Skewness made standard normal (D'Agostino 1970).
double normal_of_skewness(const Moments& m) {
  const double n = m.size;
  const double y = m.skewness * std::sqrt((n + 1.0) * (n + 3.0) / (6.0 * (n - 2.0)));
  const double beta = 3.0 * (n * n + 27.0 * n - 70.0) * (n + 1.0) * (n + 3.0) /
                      ((n - 2.0) * (n + 5.0) * (n + 7.0) * (n + 9.0));
  const double w2 = std::sqrt(2.0 * (beta - 1.0)) - 1.0;
  const double delta = 1.0 / std::sqrt(0.5 * std::log(w2));
  const double alpha = std::sqrt(2.0 / (w2 - 1.0));
  return delta * std::asinh(y / alpha);
}

/// Kurtosis made standard normal (Anscombe and Glynn 1983).
double normal_of_kurtosis(const Moments& m) {
  const double n = m.size;
  const double expected = 3.0 * (n - 1.0) / (n + 1.0);
  const double variance =
      24.0 * n * (n - 2.0) * (n - 3.0) / ((n + 1.0) * (n + 1.0) * (n + 3.0) * (n + 5.0));
  const double x = (m.kurtosis - expected) / std::sqrt(variance);
  const double beta = 6.0 * (n * n - 5.0 * n + 2.0) / ((n + 7.0) * (n + 9.0)) *
                      std::sqrt(6.0 * (n + 3.0) * (n + 5.0) / (n * (n - 2.0) * (n - 3.0)));
  const double a = 6.0 + 8.0 / beta * (2.0 / beta + std::sqrt(1.0 + 4.0 / (beta * beta)));
  const double t = (1.0 - 2.0 / a) / (1.0 + x * std::sqrt(2.0 / (a - 4.0)));
  return ((1.0 - 2.0 / (9.0 * a)) - std::cbrt(t)) / std::sqrt(2.0 / (9.0 * a));
}

std::vector<double> sums_over(const std::vector<double>& values, std::size_t length) {
  std::vector<double> sums;
  sums.reserve(values.size() / length);
  for (std::size_t first = 0; first + length <= values.size(); first += length) {
    double sum = 0.0;
    for (std::size_t k = first; k < first + length; ++k) sum += values[k];
    sums.push_back(sum / std::sqrt(static_cast<double>(length)));
  }
  return sums;
}

/// u_k^2 u_{k-l} - u_k u_{k-l}^2 has the mean 0 if time may run backwards, and the variance 6.
Test asymmetry(const std::vector<double>& u, std::size_t lag) {
  double sum = 0.0;
  for (std::size_t k = lag; k < u.size(); ++k) sum += u[k] * u[k - lag] * (u[k] - u[k - lag]);
  return {"rises and falls of the rate differ in shape",
          statistics::log_normal_tails(sum / std::sqrt(6.0 * static_cast<double>(u.size())))};
}

Test farthest(const std::vector<double>& u) {
  double most = 0.0;
  for (const double v : u) most = std::max(most, std::abs(v));
  return {fmt::format("the farthest value is {:.1f} sigma off", most),
          statistics::log_of_smallest(statistics::log_normal_tails(most),
                                      static_cast<double>(u.size()))};
}

}  // namespace

Tests test_distribution(const StandardisedResidual& residual) {
  constexpr std::size_t kFewest = 100;
  Tests tests{farthest(residual.values), asymmetry(residual.values, 1),
              asymmetry(residual.values, 3)};
  for (const std::size_t length : {1U, 4U, 16U, 64U}) {
    const std::vector<double> sums = sums_over(residual.values, length);
    if (sums.size() < kFewest) break;
    const Moments moments = moments_of(sums);
    const double scale_s = static_cast<double>(length) * residual.hypothesis->data().period_s();
    tests.push_back({fmt::format("over {} s the noise is skewed ({:+.3f})",
                                 units::in_figures(scale_s), moments.skewness),
                     statistics::log_normal_tails(normal_of_skewness(moments))});
    tests.push_back({fmt::format("over {} s the tails of the noise are not normal (excess "
                                 "kurtosis {:+.3f})",
                                 units::in_figures(scale_s), moments.kurtosis - 3.0),
                     statistics::log_normal_tails(normal_of_kurtosis(moments))});
  }
  return tests;
}

}  // namespace zerorate::diagnose
