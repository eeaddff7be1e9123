#include "host_tools/lib/statistics/tails.hpp"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <numbers>

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

double log_chi_squared_tail(double x, double freedom) {
  return log_gamma_tail(0.5 * freedom, 0.5 * x);
}

double log_chi_squared_lower_tail(double x, double freedom) {
  return std::log(std::max(boost::math::gamma_p(0.5 * freedom, 0.5 * x), kUnderflow));
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

}  // namespace zerorate::statistics
