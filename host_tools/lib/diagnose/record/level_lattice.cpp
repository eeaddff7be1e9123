#include "host_tools/lib/diagnose/record/level_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace zerorate::diagnose {
namespace {

constexpr double kTolerance = 0.1;         // share of a step
constexpr double kSinglePrecision = 4e-7;  // rounding of a float, over the value

/// How far apart two equal values of a range may be.
double single_precision_of(double least, double most) {
  return kSinglePrecision * std::max(std::abs(least), std::abs(most));
}

/// Distinct values with their counts; equal to the last digits of single precision.
std::vector<std::pair<double, std::size_t>> levels_of(std::span<const double> values) {
  std::vector<double> sorted(values.begin(), values.end());
  std::ranges::sort(sorted);
  const double same = single_precision_of(sorted.front(), sorted.back());
  std::vector<std::pair<double, std::size_t>> levels;
  for (const double value : sorted) {
    if (!levels.empty() && value - levels.back().first <= same) {
      ++levels.back().second;
    } else {
      levels.emplace_back(value, 1);
    }
  }
  return levels;
}

}  // namespace

std::optional<LevelLattice> find_lattice(std::span<const double> values) {
  const auto levels = levels_of(values);
  if (levels.size() < 2 || 4 * levels.size() > values.size()) return std::nullopt;
  std::vector<double> gaps;
  gaps.reserve(levels.size());
  for (std::size_t i = 1; i < levels.size(); ++i) {
    gaps.push_back(levels[i].first - levels[i - 1].first);
  }
  std::vector<double> sorted = gaps;
  std::ranges::sort(sorted);
  const double smallest = sorted[sorted.size() / 20];
  // Number the levels, then take the spacing from the outermost ones.
  std::vector<std::size_t> numbers{0};
  numbers.reserve(levels.size());
  for (const double gap : gaps) {
    const double steps = std::round(gap / smallest);
    if (steps < 1.0 || std::abs(gap / smallest - steps) > 0.3 * std::max(1.0, 0.1 * steps)) {
      return std::nullopt;
    }
    numbers.push_back(numbers.back() + static_cast<std::size_t>(steps));
  }
  LevelLattice lattice{.offset = levels.front().first};
  lattice.step = (levels.back().first - lattice.offset) / static_cast<double>(numbers.back());
  lattice.counts.resize(numbers.back() + 1);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const double expected = lattice.offset + lattice.step * static_cast<double>(numbers[i]);
    if (std::abs(levels[i].first - expected) > kTolerance * lattice.step) return std::nullopt;
    lattice.counts[numbers[i]] += levels[i].second;
  }
  return lattice;
}

ExtremeCounts count_extremes(std::span<const double> values) {
  const auto [least, most] = std::ranges::minmax(values);
  const double same = single_precision_of(least, most);
  ExtremeCounts counts;
  for (const double value : values) {
    if (value - least <= same) ++counts.lowest;
    if (most - value <= same) ++counts.highest;
  }
  return counts;
}

}  // namespace zerorate::diagnose
