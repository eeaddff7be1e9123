#include "host_tools/lib/identify/allan_deviation.hpp"
#include "host_tools/lib/recording/error.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <stdexcept>

namespace zerorate::identify {
namespace {

// The estimate of alpha has a standard error of 2 / sqrt(averages): 100 round to the right integer
// in 99 of 100 cases, and a wrong one can claim ten times the freedom.
constexpr std::size_t kFewestAverages = 100;
// Three streams of 2048 doubles fill the first-level cache.
constexpr std::size_t kTile = 2048;

using Block = Eigen::Map<const Eigen::ArrayXd>;

Block block(std::span<const double> values, std::size_t first, std::size_t size) {
  return {values.data() + first, static_cast<Eigen::Index>(size)};
}

// a_0 = 0, a_k = sum of the first k deviations from the mean, each rounded once (Neumaier's sum):
// the second differences of a long plain sum drown in its rounding.
std::vector<double> running_sum(std::span<const double> rate) {
  const double centre = block(rate, 0, rate.size()).mean();
  if (!std::isfinite(centre)) throw recording::DataError("Allan deviation: a rate is not finite");
  std::vector<double> sums(rate.size() + 1);
  double sum = 0.0;
  double lost = 0.0;
  for (std::size_t k = 0; k < rate.size(); ++k) {
    const double term = rate[k] - centre;
    const double next = sum + term;
    lost += std::abs(sum) >= std::abs(term) ? (sum - next) + term : (term - next) + sum;
    sum = next;
    sums[k + 1] = sum + lost;
  }
  return sums;
}

double tile_sum(std::span<const double> angle, std::size_t first, std::size_t size,
                std::size_t factor) {
  const auto start = block(angle, first, size);
  const auto middle = block(angle, first + factor, size);
  const auto end = block(angle, first + 2 * factor, size);
  return ((end - middle) - (middle - start)).square().sum();
}

std::vector<double> variances_of(std::span<const double> angle,
                                 std::span<const std::size_t> factors) {
  std::vector<double> sums(factors.size());
  for (std::size_t first = 0; first < angle.size(); first += kTile) {
    for (std::size_t i = 0; i < factors.size(); ++i) {
      const std::size_t reach = first + 2 * factors[i];
      if (reach >= angle.size()) continue;
      sums[i] += tile_sum(angle, first, std::min(kTile, angle.size() - reach), factors[i]);
    }
  }
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const auto m = static_cast<double>(factors[i]);
    const auto terms = static_cast<double>(angle.size() - 2 * factors[i]);
    sums[i] /= 2.0 * m * m * terms;
  }
  return sums;
}

std::vector<double> averages_of(std::span<const double> angle, std::size_t factor) {
  std::vector<double> averages((angle.size() - 1) / factor);
  for (std::size_t j = 0; j < averages.size(); ++j) {
    averages[j] = (angle[(j + 1) * factor] - angle[j * factor]) / static_cast<double>(factor);
  }
  return averages;
}

double lag_one_autocorrelation(std::span<const double> values) {
  const auto size = values.size();
  const double centre = block(values, 0, values.size()).mean();
  const double power = (block(values, 0, size) - centre).square().sum();
  const double lagged =
      ((block(values, 0, size - 1) - centre) * (block(values, 1, size - 1) - centre)).sum();
  return power > 0.0 ? lagged / power : 0.0;
}

AllanPoint point_of(double tau_s, double variance, double edf, double coverage, PowerLaw noise) {
  const boost::math::chi_squared distribution(edf);
  const double tail = 0.5 * (1.0 - coverage);
  const double upper = boost::math::quantile(boost::math::complement(distribution, tail));
  const double lower = boost::math::quantile(distribution, tail);
  return {tau_s,
          std::sqrt(variance),
          std::sqrt(variance * edf / upper),
          std::sqrt(variance * edf / lower),
          edf,
          noise};
}

}  // namespace

std::vector<std::size_t> averaging_factors(std::size_t samples, double points_per_decade) {
  const double longest = static_cast<double>(samples) / 3.0;
  std::vector<std::size_t> factors;
  for (double step = 0.0;; step += 1.0) {
    const double factor = std::round(std::pow(10.0, step / points_per_decade));
    if (factor > longest) return factors;
    const auto m = static_cast<std::size_t>(factor);
    if (factors.empty() || factors.back() != m) factors.push_back(m);
  }
}

std::vector<double> allan_variances(std::span<const double> rate,
                                    std::span<const std::size_t> factors) {
  const auto fits = [&](std::size_t m) { return m >= 1 && m <= rate.size() / 2; };
  if (!std::all_of(factors.begin(), factors.end(), fits)) {
    throw std::invalid_argument("allan_variances: an averaging factor is outside 1 .. samples/2");
  }
  return variances_of(running_sum(rate), factors);
}

double equivalent_degrees_of_freedom(PowerLaw noise, std::size_t phases, std::size_t factor) {
  const auto n = static_cast<double>(phases);
  const auto m = static_cast<double>(factor);
  switch (noise) {
    case PowerLaw::angle_white:
      return (n + 1.0) * (n - 2.0 * m) / (2.0 * (n - m));
    case PowerLaw::angle_flicker:
      return std::exp(
          std::sqrt(std::log((n - 1.0) / (2.0 * m)) * std::log((2.0 * m + 1.0) * (n - 1.0) / 4.0)));
    case PowerLaw::rate_white:
      return (3.0 * (n - 1.0) / (2.0 * m) - 2.0 * (n - 2.0) / n) * 4.0 * m * m /
             (4.0 * m * m + 5.0);
    case PowerLaw::rate_flicker:
      return factor == 1 ? 2.0 * (n - 2.0) * (n - 2.0) / (2.3 * n - 4.9)
                         : 5.0 * n * n / (4.0 * m * (n + 3.0 * m));
    case PowerLaw::rate_random_walk:
      return (n - 2.0) / m * ((n - 1.0) * (n - 1.0) - 3.0 * m * (n - 1.0) + 4.0 * m * m) /
             ((n - 3.0) * (n - 3.0));
  }
  throw std::invalid_argument("equivalent_degrees_of_freedom: no such power law");
}

PowerLaw identify_power_law(std::span<const double> averages) {
  std::vector<double> values(averages.begin(), averages.end());
  // The order of integration delta of a series has lag-1 autocorrelation delta / (1 - delta) below
  // 1/4; above, the series is differenced first.
  double differences = 0.0;
  double delta = 0.0;
  for (;; differences += 1.0) {
    const double r = lag_one_autocorrelation(values);
    delta = r / (1.0 + r);
    if (delta < 0.25 || differences >= 2.0) break;
    for (std::size_t k = 0; k + 1 < values.size(); ++k) values[k] = values[k + 1] - values[k];
    values.pop_back();
  }
  const double alpha = std::clamp(std::round(-2.0 * (delta + differences)), -2.0, 2.0);
  constexpr std::array kLaws{PowerLaw::rate_random_walk, PowerLaw::rate_flicker,
                             PowerLaw::rate_white, PowerLaw::angle_flicker, PowerLaw::angle_white};
  return kLaws[static_cast<std::size_t>(alpha + 2.0)];
}

std::vector<AllanPoint> allan_deviation(std::span<const double> rate, double sample_period_s,
                                        const AllanOptions& options) {
  constexpr std::size_t kFewest = 8;
  if (rate.size() < kFewest) {
    throw recording::DataError("allan_deviation: fewer than 8 samples");
  }
  const std::vector<std::size_t> factors =
      averaging_factors(rate.size(), options.points_per_decade);
  const std::vector<double> angle = running_sum(rate);
  const std::vector<double> variances = variances_of(angle, factors);
  std::vector<AllanPoint> points;
  PowerLaw noise = PowerLaw::rate_white;
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const std::vector<double> averages = averages_of(angle, factors[i]);
    if (averages.size() >= kFewestAverages) noise = identify_power_law(averages);
    const double edf = equivalent_degrees_of_freedom(noise, angle.size(), factors[i]);
    const double tau_s = static_cast<double>(factors[i]) * sample_period_s;
    points.push_back(point_of(tau_s, variances[i], edf, options.coverage, noise));
  }
  return points;
}

}  // namespace zerorate::identify
