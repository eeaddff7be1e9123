#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

/// Levels of a lattice, each against the parabola through two neighbours on each side, which has an
/// error of (step / sigma)^4 / 2 of a normal distribution.
Tests test_lattice(const Problem& problem, const LevelLattice& lattice, double sigma_rad_s) {
  constexpr double kFewest = 20.0;  // values, for a count to be as good as normal
  const double step = lattice.step / sigma_rad_s;
  const double error = 0.5 * std::pow(step, 4.0);
  const double most = 0.4 * step * static_cast<double>(problem.size());  // on one level
  if (error * std::sqrt(0.5 * most) > 0.7) return {};
  double farthest = 0.0;
  std::size_t at = 0;
  double places = 0.0;
  for (std::size_t i = 2; i + 2 < lattice.counts.size(); ++i) {
    const auto count = [&](std::size_t level) {
      return static_cast<double>(lattice.counts[level]);
    };
    const double near = count(i - 1) + count(i + 1);
    const double far = count(i - 2) + count(i + 2);
    const double expected = (4.0 * near - far) / 6.0;
    if (expected < kFewest) continue;
    places += 1.0;
    const double z = (count(i) - expected) / std::sqrt(expected + (16.0 * near + far) / 36.0);
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
  // A pile at an end of the range is told by another effect.
  if (is_clipped) return {};
  return test_lattice(problem, *problem.lattice(), 1.0 / std::sqrt(explanation.information()));
}

}  // namespace zerorate::diagnose
