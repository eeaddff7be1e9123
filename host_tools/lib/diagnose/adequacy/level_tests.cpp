#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host_tools/lib/diagnose/adequacy/adequacy.hpp"
#include "host_tools/lib/diagnose/adequacy/tails.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::size_t kNeighbours = 8;  // levels on each side that a level is compared with

/// Distinct values of what was measured and neither clipped nor replaced, with their counts.
std::vector<std::pair<double, double>> counted(const Explanation& explanation) {
  std::vector<double> values;
  for (std::size_t k = 0; k < explanation.problem().size(); ++k) {
    if (!explanation.is_replaced()[k]) values.push_back(explanation.problem().rate_rad_s()[k]);
  }
  std::ranges::sort(values);
  std::vector<std::pair<double, double>> levels;
  for (const double value : values) {
    if (levels.empty() || value > levels.back().first) levels.emplace_back(value, 0.0);
    levels.back().second += 1.0;
  }
  return levels;
}

}  // namespace

Tests test_levels(const Remainder& remainder) {
  const Explanation& explanation = *remainder.explanation;
  const auto levels = counted(explanation);
  // Neighbours must be near enough to be as likely.
  const double near = 0.5 / std::sqrt(explanation.information());
  double least = 0.0;
  double at = 0.0;
  double places = 0.0;
  for (std::size_t i = kNeighbours; i + kNeighbours < levels.size(); ++i) {
    if (levels[i + kNeighbours].first - levels[i - kNeighbours].first > near) continue;
    double around = 0.0;
    for (std::size_t j = i - kNeighbours; j <= i + kNeighbours; ++j) around += levels[j].second;
    around -= levels[i].second;
    places += 1.0;
    // What the neighbours hold is an estimate itself, of at least a half.
    const double mean = (around + 3.0 * std::sqrt(around)) / (2.0 * double{kNeighbours});
    const double log_p = log_poisson_tail(levels[i].second - 1.0, mean);
    if (log_p >= least) continue;
    least = log_p;
    at = levels[i].first;
  }
  if (places == 0.0) return {};
  constexpr double kDegPerRad = 57.29577951308232;
  return {{fmt::format("the value {:.6g} deg/s occurs far more often than its neighbours",
                       (at + explanation.problem().median_rad_s()) * kDegPerRad),
           log_of_smallest(least, places)}};
}

}  // namespace zerorate::diagnose
