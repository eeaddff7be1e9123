#include "host_tools/lib/diagnose/record/cell_of_zero.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace zerorate::diagnose {
namespace {

/// The levels from `first` to `last`, all well hit, with zero among them.
struct Window {
  int first = 0;
  int last = 0;

  [[nodiscard]] int size() const { return last - first + 1; }
  /// Unit of the places in a regression.
  [[nodiscard]] double reach() const { return std::max(-first, last); }
};

/// Levels in the tails belong to what moves in a rest, not to its density.
Window window_of(const LevelsAboutZero& levels) {
  constexpr double kLeastShare = 0.03;  // share of the fullest level beside zero
  constexpr double kFewestHits = 8.0;
  double most = 0.0;
  for (int level = 1; level <= LevelsAboutZero::kReach; ++level) {
    most = std::max({most, levels.count(level), levels.count(-level)});
  }
  const auto is_hit = [&](int level) {
    return std::abs(level) <= LevelsAboutZero::kReach &&
           levels.count(level) >= std::max(kFewestHits, kLeastShare * most);
  };
  Window window;
  while (is_hit(window.first - 1)) --window.first;
  while (is_hit(window.last + 1)) ++window.last;
  return window;
}

/// Middle of the cell of a level, in steps.
double middle_of(int level, double offset) {
  if (level == 0) return 0.0;
  return level < 0 ? level - offset : level + offset;
}

/// Logarithm of the mean of a density over a cell of zero that is two steps wide, over its mean
/// over one step, to second order: g'' / g times half the difference of the mean squares, 1/3 and
/// 1/12.
double log_mean_over_wide_cell(double slope, double curvature) {
  constexpr double kHalfDifference = 0.125;
  return std::log1p(kHalfDifference * (curvature + slope * slope));
}

/// Powers of the place from 0 on, and 1 at zero alone.
Eigen::MatrixXd design_of(const Window& window, double offset, int order) {
  Eigen::MatrixXd design(window.size(), order + 2);
  for (int level = window.first; level <= window.last; ++level) {
    const int row = level - window.first;
    double power = 1.0;
    for (int i = 0; i <= order; ++i) {
      design(row, i) = power;
      power *= middle_of(level, offset) / window.reach();
    }
    design(row, order + 1) = level == 0 ? 1.0 : 0.0;
  }
  return design;
}

}  // namespace

std::optional<double> step_of(const std::map<float, std::size_t>& values) {
  constexpr std::size_t kFewestValues = 4;
  constexpr double kOffLevel = 0.1;
  if (values.size() < kFewestValues) return std::nullopt;
  double least = std::numeric_limits<double>::infinity();
  double before = -std::numeric_limits<double>::infinity();
  for (const auto& [value, count] : values) {
    least = std::min(least, double{value} - before);
    before = double{value};
  }
  const auto steps_of = [](double value, double step) { return std::round(value / step); };
  const double greatest = double{values.rbegin()->first} - double{values.begin()->first};
  const double step = greatest / steps_of(greatest, least);
  bool has_zero = false;
  for (const auto& [value, count] : values) {
    const double steps = steps_of(double{value}, step);
    if (std::abs(double{value} / step - steps) > kOffLevel) return std::nullopt;
    has_zero = has_zero || steps == 0.0;
  }
  return has_zero ? std::optional{step} : std::nullopt;
}

LevelsAboutZero levels_about_zero(const std::map<float, std::size_t>& values, double step) {
  constexpr int kReach = LevelsAboutZero::kReach;
  LevelsAboutZero levels{.step = step, .counts = std::vector<double>(2 * kReach + 1)};
  for (const auto& [value, count] : values) {
    const double level = std::round(double{value} / step);
    if (std::abs(level) > kReach) continue;
    levels.counts[static_cast<std::size_t>(level + kReach)] += static_cast<double>(count);
  }
  return levels;
}

std::optional<WidthOfZero> width_of_zero(const LevelsAboutZero& levels, double offset) {
  constexpr int kNeighbours = 2;   // fewest on each side
  constexpr int kManyLevels = 12;  // from here on the density may have two more bends
  constexpr int kPasses = 30;
  const Window window = window_of(levels);
  if (-window.first < kNeighbours || window.last < kNeighbours) return std::nullopt;
  const int order = window.size() < kManyLevels ? 2 : 4;
  constexpr int kFewestLeft = 2;
  const int freedom = window.size() - order - 2;
  if (freedom < kFewestLeft) return std::nullopt;
  const Eigen::MatrixXd design = design_of(window, offset, order);
  Eigen::VectorXd counts(window.size());
  for (int row = 0; row < window.size(); ++row) counts[row] = levels.count(window.first + row);
  // Iteratively reweighted least squares; it begins at the counts themselves.
  Eigen::VectorXd expected = counts.array() + 0.5;
  Eigen::VectorXd coefficients;
  Eigen::MatrixXd covariance;
  for (int pass = 0; pass < kPasses; ++pass) {
    const Eigen::VectorXd working =
        expected.array().log() + (counts - expected).array() / expected.array();
    covariance = (design.transpose() * expected.asDiagonal() * design).inverse();
    coefficients = covariance * design.transpose() * expected.asDiagonal() * working;
    expected = (design * coefficients).array().min(700.0).exp();
  }
  const double chi_squared = ((counts - expected).array().square() / expected.array()).sum();
  const double dispersion = std::max(1.0, chi_squared / freedom);
  const double variance = dispersion * covariance(order + 1, order + 1);
  if (!std::isfinite(variance) || !(variance > 0.0)) return std::nullopt;
  const double reach = window.reach();
  const double beside = offset > 0.0
                            ? log_mean_over_wide_cell(coefficients[1] / reach,
                                                      2.0 * coefficients[2] / (reach * reach))
                            : 0.0;
  return WidthOfZero{coefficients[order + 1] - beside, std::sqrt(variance),
                     static_cast<double>(freedom)};
}

}  // namespace zerorate::diagnose
