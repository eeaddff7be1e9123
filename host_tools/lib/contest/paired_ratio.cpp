#include "host_tools/lib/contest/paired_ratio.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "host_tools/lib/evaluate/drive_scores.hpp"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::contest {
namespace {

using Pair = const std::array<double, 2>*;

double root_of_ratio(const std::vector<Pair>& pairs) {
  double own = 0.0;
  double other = 0.0;
  for (const Pair pair : pairs) {
    own += (*pair)[0];
    other += (*pair)[1];
  }
  return std::sqrt(own / other);
}

/// Sums of the least squares of drifts over turns.
struct TurnSums {
  double turn_turn = 0.0;
  double turn_drift = 0.0;
  double drift_drift = 0.0;
  std::size_t drives = 0;

  [[nodiscard]] double slope_without(const Turn& one) const {
    return (turn_drift - one.turn_rad * one.drift_rad) / (turn_turn - one.turn_rad * one.turn_rad);
  }
};

TurnSums sums_of(const std::vector<std::vector<Turn>>& logs) {
  TurnSums sums;
  for (const auto& log : logs) {
    for (const Turn& one : log) {
      sums.turn_turn += one.turn_rad * one.turn_rad;
      sums.turn_drift += one.turn_rad * one.drift_rad;
      sums.drift_drift += one.drift_rad * one.drift_rad;
      ++sums.drives;
    }
  }
  return sums;
}

}  // namespace

statistics::BootstrapFigure paired_ratio(const SquarePairs& logs) {
  std::vector<std::vector<Pair>> parts;
  for (const auto& log : logs) {
    auto& part = parts.emplace_back();
    for (const auto& pair : log) part.push_back(&pair);
  }
  if (parts.size() < evaluate::kFewestDrivesOfARatio) {
    std::vector<std::vector<Pair>> singles;
    for (const auto& part : parts) {
      for (const Pair pair : part) singles.push_back({pair});
    }
    parts = std::move(singles);
  }
  if (parts.size() < evaluate::kFewestDrivesOfARatio) return {};
  const auto ratio = [&](const std::vector<std::size_t>& drawn) {
    std::vector<Pair> pairs;
    for (const std::size_t one : drawn) {
      pairs.insert(pairs.end(), parts[one].begin(), parts[one].end());
    }
    return root_of_ratio(pairs);
  };
  return statistics::bootstrap(parts.size(), ratio,
                               random::RandomStream{1}.substream("comparison of logs"));
}

std::optional<ScaleInTurns> scale_in_turns(const std::vector<std::vector<Turn>>& logs) {
  const TurnSums sums = sums_of(logs);
  if (sums.drives < evaluate::kFewestDrivesOfARatio || !(sums.turn_turn > 0.0)) return std::nullopt;
  ScaleInTurns scale{.error = sums.turn_drift / sums.turn_turn};
  const double left = sums.drift_drift - scale.error * sums.turn_drift;
  scale.sigma =
      std::sqrt(std::max(left, 0.0) / static_cast<double>(sums.drives - 1) / sums.turn_turn);
  SquarePairs pairs;
  for (const auto& log : logs) {
    auto& part = pairs.emplace_back();
    for (const Turn& one : log) {
      const double rest = one.drift_rad - sums.slope_without(one) * one.turn_rad;
      part.push_back({rest * rest, one.drift_rad * one.drift_rad});
    }
  }
  scale.ratio = paired_ratio(pairs);
  return scale;
}

}  // namespace zerorate::contest
