#include "host_tools/lib/identify/rounding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host_tools/lib/identify/repeats.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::identify {
namespace {

constexpr double kVarianceOfRounding = 1.0 / 12.0;  // share of a step squared

/// Variance of a normal value that is rounded to whole numbers.
double variance_of_rounded(double mean, double sigma) {
  const double reach = std::ceil(6.0 * sigma + 1.0);
  double sum = 0.0;
  double squares = 0.0;
  for (double level = -reach; level <= reach; level += 1.0) {
    const double share = statistics::normal_tail((level - 0.5 - mean) / sigma) -
                         statistics::normal_tail((level + 0.5 - mean) / sigma);
    sum += share * level;
    squares += share * level * level;
  }
  return squares - sum * sum;
}

}  // namespace

SigmaRange sigma_before_rounding(double least, double most) {
  constexpr double kFinest = 0.02;
  constexpr double kRatio = 1.02;
  constexpr double kExact = 1.0;  // Sheppard's correction is exact from here on
  const auto corrected = [](double variance) { return std::sqrt(variance - kVarianceOfRounding); };
  if (least > kExact + kVarianceOfRounding) return {corrected(least), corrected(most)};
  SigmaRange range{.lo = corrected(std::max(least, kExact)), .hi = 0.0};
  for (double sigma = kFinest; sigma < kExact; sigma *= kRatio) {
    // A mean on a level gives the least variance, and one between two of them the largest.
    const double next = kRatio * sigma;
    if (variance_of_rounded(0.0, sigma) > most || variance_of_rounded(0.5, next) < least) continue;
    range.lo = std::min(range.lo, sigma);
    range.hi = std::max(range.hi, next);
  }
  if (most > kExact + kVarianceOfRounding) range.hi = corrected(most);
  return range;
}

std::optional<std::string> remark_on_rounding(const RestSamples& samples, std::size_t axis,
                                              const IntervalEstimate& walk) {
  constexpr double kShare = 0.05;
  const double step = smallest_step(samples, axis);
  const double period_s = static_cast<double>(samples.mean_period.ns()) * 1e-9;
  if (!(step > 0.0) || !(period_s > 0.0)) return std::nullopt;
  const auto variance = [&](double value) { return value * value / (period_s * step * step); };
  if (kVarianceOfRounding < kShare * variance(walk.value)) return std::nullopt;
  const SigmaRange own = sigma_before_rounding(variance(walk.lo), variance(walk.hi));
  const double walk_of_step = step * std::sqrt(period_s) * units::kDegPerRad;
  return fmt::format(
      "The rates are rounded to steps of {:.3g} deg/s, and N contains the rounding: that of the "
      "sensor alone is {:.3g} to {:.3g} deg/s/sqrt(Hz). Smaller steps would show it.",
      step * units::kDegPerRad, own.lo * walk_of_step, own.hi * walk_of_step);
}

}  // namespace zerorate::identify
