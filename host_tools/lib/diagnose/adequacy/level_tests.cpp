#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "host_tools/lib/diagnose/adequacy/adequacy.hpp"
#include "host_tools/lib/diagnose/adequacy/tails.hpp"

namespace zerorate::diagnose {
namespace {

constexpr double kDegPerRad = 57.29577951308232;

/// A value and how often it was measured.
struct Level {
  double value = 0.0;
  double count = 0.0;
};

/// What was measured and neither clipped nor replaced.
std::vector<Level> count_levels(const Explanation& explanation) {
  std::vector<double> values;
  for (std::size_t k = 0; k < explanation.problem().size(); ++k) {
    if (!explanation.is_replaced()[k]) values.push_back(explanation.problem().rate_rad_s()[k]);
  }
  std::ranges::sort(values);
  std::vector<Level> levels;
  for (const double value : values) {
    if (levels.empty() || value > levels.back().value) levels.push_back({value, 0.0});
    levels.back().count += 1.0;
  }
  return levels;
}

/// Values that are nearly all different: one that comes again and again.
Tests test_repeated(const Problem& problem, const std::vector<Level>& levels) {
  constexpr std::size_t kNeighbours = 8;  // on each side
  double least = 0.0;
  double at = 0.0;
  double places = 0.0;
  for (std::size_t i = kNeighbours; i + kNeighbours < levels.size(); ++i) {
    double around = 0.0;
    for (std::size_t j = i - kNeighbours; j <= i + kNeighbours; ++j) around += levels[j].count;
    around -= levels[i].count;
    places += 1.0;
    // What the neighbours hold is an estimate itself, of at least a half.
    const double mean = (around + 3.0 * std::sqrt(around)) / (2.0 * double{kNeighbours});
    const double log_p = log_poisson_tail(levels[i].count - 1.0, mean);
    if (log_p >= least) continue;
    least = log_p;
    at = levels[i].value;
  }
  if (places == 0.0) return {};
  return {{fmt::format("the value {:.6g} deg/s occurs far more often than its neighbours",
                       (at + problem.median_rad_s()) * kDegPerRad),
           log_of_smallest(least, places)}};
}

/// How many values the noise lets each level of a lattice expect: every value predicted from all
/// others, with a normal error before rounding.
std::vector<double> expected_counts(const Explanation& explanation, const LevelLattice& lattice,
                                    std::vector<double>& counts) {
  constexpr double kReach = 6.0;  // standard deviations
  const double information = explanation.information();
  const double rounding = lattice.step * lattice.step / 12.0;
  const double sigma = std::sqrt(std::max(1.0 / information - rounding, rounding));
  const std::vector<double>& rate = explanation.problem().rate_rad_s();
  const std::vector<double>& weighted = explanation.weighted();
  const auto levels = static_cast<std::ptrdiff_t>(lattice.counts.size());
  const auto reach = static_cast<std::ptrdiff_t>(kReach * sigma / lattice.step) + 2;
  counts.assign(lattice.counts.size(), 0.0);
  std::vector<double> expected(lattice.counts.size());
  for (std::size_t k = 0; k < explanation.problem().size(); ++k) {
    if (explanation.is_replaced()[k]) continue;
    const std::ptrdiff_t level = std::lround((rate[k] - lattice.offset) / lattice.step);
    if (level >= 0 && level < levels) counts[static_cast<std::size_t>(level)] += 1.0;
    const double predicted = (rate[k] - weighted[k] / information - lattice.offset) / lattice.step;
    const std::ptrdiff_t centre = std::lround(predicted);
    double below = 0.0;
    for (std::ptrdiff_t at = centre - reach; at <= centre + reach; ++at) {
      const double end = (static_cast<double>(at) + 0.5 - predicted) * lattice.step / sigma;
      const double up_to = 0.5 * std::erfc(-end / std::numbers::sqrt2);
      if (at >= 0 && at < levels) expected[static_cast<std::size_t>(at)] += up_to - below;
      below = up_to;
    }
  }
  return expected;
}

/// Levels of a lattice, each against what it and two neighbours on each side let expect.
Tests test_lattice(const Explanation& explanation, const LevelLattice& lattice, bool is_clipped) {
  constexpr double kFewest = 20.0;  // values, for a count to be as good as normal
  const Problem& problem = explanation.problem();
  std::vector<double> counts;
  const std::vector<double> expected = expected_counts(explanation, lattice, counts);
  // A pile at an end of the range is told by another effect.
  const std::size_t margin = is_clipped ? 3 : 2;
  double farthest = 0.0;
  std::size_t at = 0;
  double places = 0.0;
  for (std::size_t i = margin; i + margin < counts.size(); ++i) {
    double near = 0.0;
    double due = 0.0;
    for (const std::size_t j : {i - 2, i - 1, i + 1, i + 2}) {
      near += counts[j];
      due += expected[j];
    }
    if (expected[i] < kFewest || near < kFewest) continue;
    const double share = expected[i] / due;
    places += 1.0;
    const double z = (counts[i] - share * near) / std::sqrt(share * near * (1.0 + share));
    if (std::abs(z) <= std::abs(farthest)) continue;
    farthest = z;
    at = i;
  }
  if (places == 0.0) return {};
  const double value = lattice.offset + lattice.step * static_cast<double>(at);
  return {
      {fmt::format("the value {:.6g} deg/s occurs {} often than its neighbours let expect",
                   (value + problem.median_rad_s()) * kDegPerRad, farthest > 0.0 ? "more" : "less"),
       log_of_smallest(log_normal_tails(farthest), places)}};
}

}  // namespace

Tests test_levels(const Remainder& remainder) {
  const Explanation& explanation = *remainder.explanation;
  const Problem& problem = explanation.problem();
  const bool is_clipped = std::ranges::any_of(
      explanation.parts(), [](const Part& part) { return !(part.clipped == Range{}); });
  if (!problem.lattice()) return test_repeated(problem, count_levels(explanation));
  return test_lattice(explanation, *problem.lattice(), is_clipped);
}

}  // namespace zerorate::diagnose
