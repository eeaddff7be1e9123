#include "host_tools/lib/statistics/search_significance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace zerorate::statistics {
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
