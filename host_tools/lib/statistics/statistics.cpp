#include "host_tools/lib/statistics/statistics.hpp"

#include <algorithm>
#include <array>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

namespace zerorate::statistics {

namespace {

constexpr double kUnderflow = 1e-290;

/// log Q(a, x), by its leading term where it underflows.
double log_gamma_tail(double a, double x) {
  if (x <= 0.0) return 0.0;
  const double tail = boost::math::gamma_q(a, x);
  if (tail > kUnderflow) return std::log(tail);
  return (a - 1.0) * std::log(x) - x - std::lgamma(a);
}

}  // namespace

double log_normal_tails(double z) {
  const double tail = std::erfc(std::abs(z) / std::numbers::sqrt2);
  if (tail > kUnderflow) return std::log(tail);
  return -0.5 * z * z - std::log(std::abs(z)) - 0.5 * std::log(std::numbers::pi / 2.0);
}

double chi_squared_tail(double x, double freedom) {
  return boost::math::gamma_q(0.5 * freedom, 0.5 * x);
}

double log_chi_squared_tail(double x, double freedom) {
  return log_gamma_tail(0.5 * freedom, 0.5 * x);
}

double log_chi_squared_lower_tail(double x, double freedom) {
  return std::log(std::max(boost::math::gamma_p(0.5 * freedom, 0.5 * x), kUnderflow));
}

double log_student_tail(double t, double freedom) {
  const boost::math::students_t student(freedom);
  return std::log(std::max(boost::math::cdf(boost::math::complement(student, t)), kUnderflow));
}

double log_chi_squared_tails(double x, double freedom) {
  const double upper = log_gamma_tail(0.5 * freedom, 0.5 * x);
  const double lower = log_chi_squared_lower_tail(x, freedom);
  return std::min(0.0, std::numbers::ln2 + std::min(upper, lower));
}

double log_poisson_tail(double count, double mean) {
  if (count <= 0.0) return 0.0;
  const double tail = boost::math::gamma_p(count, mean);
  if (tail > kUnderflow) return std::log(tail);
  return count * std::log(mean) - mean - std::lgamma(count + 1.0);
}

double log_p_of_even_lengths(std::span<const std::vector<double>> groups) {
  double statistic = 0.0;
  double freedom = 0.0;
  for (const std::vector<double>& lengths : groups) {
    const auto m = static_cast<double>(lengths.size());
    if (m < 2.0) continue;
    double sum = 0.0;
    double logs = 0.0;
    for (const double length : lengths) {
      sum += length;
      logs += std::log(length);
    }
    statistic += 2.0 * m * (std::log(sum / m) - logs / m) / (1.0 + (m + 1.0) / (6.0 * m));
    freedom += m - 1.0;
  }
  return freedom > 0.0 ? log_chi_squared_lower_tail(statistic, freedom) : 0.0;
}

std::vector<double> rank_sum_tail(std::size_t own, std::size_t others) {
  // Orders by their pairs: the coefficients of prod_i (1 - q^(others + i)) / (1 - q^i), as shares.
  std::vector<double> tail(own * others / 2 + 1);
  tail[0] = 1.0;
  for (std::size_t i = 1; i <= own; ++i) {
    for (std::size_t u = tail.size(); u-- > others + i;) tail[u] -= tail[u - others - i];
    for (double& one : tail) one *= static_cast<double>(i) / static_cast<double>(others + i);
    for (std::size_t u = i; u < tail.size(); ++u) tail[u] += tail[u - i];
  }
  std::partial_sum(tail.begin(), tail.end(), tail.begin());
  return tail;
}

double log_of_smallest(double log_p, double places) {
  return std::min(0.0, log_p + std::log(std::max(1.0, places)));
}

double normal_of_chi_squared(double x, double freedom) {
  const double spread = 2.0 / (9.0 * freedom);
  return (std::cbrt(x / freedom) - (1.0 - spread)) / std::sqrt(spread);
}

namespace {

constexpr double kFar = 300.0;  // nats: erfc is about to underflow

/// log P(chi squared > 2 gain), also where the probability underflows.
double log_tail(double gain, double parameters) {
  if (gain <= 0.0) return 0.0;
  if (parameters > 1.0) return -gain;
  if (gain < kFar) return std::log(std::erfc(std::sqrt(gain)));
  return -gain - 0.5 * std::log(std::numbers::pi * gain);
}

}  // namespace

double surprisal_of_free(double gain_nats, double parameters) {
  return -log_tail(gain_nats, parameters);
}

double surprisal_of_strength(double gain_nats) {
  return gain_nats <= 0.0 ? 0.0 : std::numbers::ln2 - log_tail(gain_nats, 1.0);
}

double surprisal_of_search(double gain_nats, double parameters, double crossings) {
  const double single = log_tail(gain_nats, parameters);
  const double search = std::log(std::max(crossings, 1e-300)) - gain_nats;
  const double larger = std::max(single, search);
  const double log_sum = larger + std::log(std::exp(single - larger) + std::exp(search - larger));
  return std::max(0.0, -log_sum);
}

MeanBeforeRounding::MeanBeforeRounding(double sigma) {
  constexpr double kSmooth = 0.6;
  if (sigma > kSmooth) return;
  for (double sign = -1.0; terms_ < kMostTerms; sign = -sign) {
    const double order = std::numbers::pi * static_cast<double>(terms_ + 1);
    const double factor = sign / order * std::exp(-2.0 * order * order * sigma * sigma);
    if (std::abs(factor) < std::numeric_limits<double>::epsilon()) return;
    factors_[terms_++] = factor;
  }
}

double MeanBeforeRounding::operator()(double mean) const {
  if (terms_ == 0) return mean;
  const auto error_and_slope = [&](double x) {
    const double angle = 2.0 * std::numbers::pi * x;
    const double twice_cosine = 2.0 * std::cos(angle);
    std::complex<double> turn{0.5 * twice_cosine, std::sin(angle)};
    std::complex<double> turn_before = 1.0;
    double error = x - mean;
    double slope = 0.0;
    for (std::size_t k = 0; k < terms_; ++k) {
      error += factors_[k] * turn.imag();
      slope += factors_[k] * static_cast<double>(k + 1) * turn.real();
      turn_before = std::exchange(turn, twice_cosine * turn - turn_before);
    }
    return std::pair{error, 1.0 + 2.0 * std::numbers::pi * slope};
  };
  // Newton's steps, halved where they leave the interval that holds the root.
  constexpr int kMostSteps = 40;
  constexpr double kPrecision = 1e-4;
  double lo = mean - 0.5;
  double hi = mean + 0.5;
  double x = mean;
  for (int i = 0; i < kMostSteps; ++i) {
    const auto [error, slope] = error_and_slope(x);
    (error < 0.0 ? lo : hi) = x;
    const double newton = x - error / slope;
    const double next = newton > lo && newton < hi ? newton : 0.5 * (lo + hi);
    const bool is_close = std::abs(next - x) < kPrecision;
    x = next;
    if (is_close) break;
  }
  return x;
}

BootstrapFigure bootstrap(std::size_t size, const Statistic& statistic,
                          const random::RandomStream& stream, const BootstrapParams& params) {
  std::vector<std::size_t> drawn(size);
  std::iota(drawn.begin(), drawn.end(), std::size_t{0});
  BootstrapFigure figure{.value = statistic(drawn)};
  if (std::isnan(figure.value)) return {};
  std::vector<double> values(params.draws);
  std::int64_t number = 0;
  for (double& value : values) {
    for (std::size_t i = 0; i < size; i += params.block) {
      const double place = stream.uniform(number++) * static_cast<double>(size);
      const auto first = static_cast<std::size_t>(place);
      for (std::size_t j = 0; j < params.block && i + j < size; ++j) {
        drawn[i + j] = (first + j) % size;
      }
    }
    value = statistic(drawn);
  }
  std::ranges::sort(values);
  figure.lo = values[params.draws / 40];
  figure.hi = values[params.draws - 1 - params.draws / 40];
  return figure;
}

}  // namespace zerorate::statistics
