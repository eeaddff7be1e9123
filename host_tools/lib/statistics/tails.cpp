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

}  // namespace zerorate::statistics
