#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/truth/truth.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::truth {
namespace {

using units::kRadPerDeg;

constexpr std::int64_t kSecond_ns = 1'000'000'000;
/// Lengths of turns in the order in which they are tried. A reference that is late by a second and
/// more shares longer ones with the gyro.
constexpr std::array kLengths_ns{kSecond_ns, 12 * kSecond_ns};

/// Turns of some length: of the reference, and of the axes of the gyro.
struct Turn {
  double length_s;
  double reference_rad;
  std::array<double, recording::kMaxAxes> axes_rad;
};

std::vector<Turn> turns_of(const Track& track, std::int64_t least_ns) {
  const Series& heading = track.heading_rad;
  const std::int64_t longest_ns = heading.longest_interval_ns();
  std::vector<Turn> turns;
  std::size_t first = 0;
  for (std::size_t k = 1; k < heading.size(); ++k) {
    if (heading.time_ns(k) - heading.time_ns(k - 1) > longest_ns) first = k;
    if (heading.time_ns(k) - heading.time_ns(first) < least_ns) continue;
    Turn turn{.length_s = units::seconds(heading.time_ns(k) - heading.time_ns(first)),
              .reference_rad = heading.value(k) - heading.value(first),
              .axes_rad = {}};
    for (std::size_t axis = 0; axis < track.axis_count; ++axis) {
      turn.axes_rad[axis] = track.turn_rad(axis, first, k);
    }
    turns.push_back(turn);
    first = k;
  }
  return turns;
}

/// A turn by an axis and by the reference [rad].
struct Pair {
  double axis_rad;
  double reference_rad;
};

/// The turns in which an axis measured. One that repeats a value for two turns did not.
std::vector<Pair> measured_by(const std::vector<Turn>& turns, std::size_t axis) {
  constexpr double kRounding_rad_s = 1e-8;
  const auto rate = [&](std::size_t k) { return turns[k].axes_rad[axis] / turns[k].length_s; };
  const auto is_same = [&](std::size_t a, std::size_t b) {
    return std::abs(rate(a) - rate(b)) < kRounding_rad_s;
  };
  std::vector<Pair> pairs;
  for (std::size_t k = 0; k < turns.size(); ++k) {
    if (k > 0 && is_same(k, k - 1)) continue;
    if (k + 1 < turns.size() && is_same(k, k + 1)) continue;
    pairs.push_back({turns[k].axes_rad[axis], turns[k].reference_rad});
  }
  return pairs;
}

/// Sums of a least-squares line through turns, about their means: a bias does not count.
VerticalAxis regress(const std::vector<Pair>& turns, std::size_t axis) {
  double mean_x = 0.0;
  double mean_y = 0.0;
  const auto count = static_cast<double>(turns.size());
  for (const Pair& turn : turns) {
    mean_x += turn.axis_rad / count;
    mean_y += turn.reference_rad / count;
  }
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (const Pair& turn : turns) {
    const double x = turn.axis_rad - mean_x;
    const double y = turn.reference_rad - mean_y;
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  if (!(xx > 0.0) || !(yy > 0.0)) return {.axis = axis, .correlation = 0.0, .turns_ratio = 0.0};
  return {.axis = axis,
          .sign = xy < 0.0 ? -1.0 : 1.0,
          .correlation = std::abs(xy) / std::sqrt(xx * yy),
          .turns_ratio = std::abs(xy) / xx};
}

bool is_followed(const VerticalAxis& candidate) {
  constexpr double kLeastCorrelation = 0.7;
  constexpr double kMostRatio = 1.25;
  return candidate.correlation >= kLeastCorrelation && candidate.turns_ratio <= kMostRatio &&
         candidate.turns_ratio >= 1.0 / kMostRatio;
}

/// The turns in which axis and reference agree within 0.3 of the larger one and 2 deg, if these are
/// most of what the reference turned; else none. Wild values and clipped turns are not among them.
std::vector<Pair> agreeing(const std::vector<Pair>& turns, double sign) {
  constexpr double kShare = 0.3;
  constexpr double kNoise_rad = 2.0 * kRadPerDeg;
  std::vector<double> biases;
  biases.reserve(turns.size());
  for (const Pair& turn : turns) biases.push_back(turn.axis_rad - sign * turn.reference_rad);
  if (biases.empty()) return {};
  const double bias_rad = statistics::median_of(biases);
  double turned_rad = 0.0;
  double agreed_rad = 0.0;
  std::vector<Pair> pairs;
  for (const Pair& turn : turns) {
    const double x = sign * (turn.axis_rad - bias_rad);
    const double y = turn.reference_rad;
    turned_rad += std::abs(y);
    if (std::abs(x - y) > kShare * std::max(std::abs(x), std::abs(y)) + kNoise_rad) continue;
    agreed_rad += std::abs(y);
    pairs.push_back(turn);
  }
  return 2.0 * agreed_rad > turned_rad ? pairs : std::vector<Pair>{};
}

/// The axis that follows the reference best; with a few faults of the gyro left out where none
/// follows it in all turns.
VerticalAxis candidate_of(const std::vector<Turn>& turns, std::size_t axis) {
  const std::vector<Pair> measured = measured_by(turns, axis);
  const VerticalAxis all = regress(measured, axis);
  if (is_followed(all)) return all;
  for (const double sign : {1.0, -1.0}) {
    const VerticalAxis most = regress(agreeing(measured, sign), axis);
    if (is_followed(most) && most.sign == sign) return most;
  }
  return all;
}

/// The axes as candidates, the best one, and all of them in words.
struct Candidates {
  VerticalAxis best{.correlation = -1.0};
  std::string told;
};

Candidates candidates_of(const Track& track, const std::vector<Turn>& turns) {
  Candidates candidates;
  for (std::size_t axis = 0; axis < track.axis_count; ++axis) {
    const VerticalAxis candidate = candidate_of(turns, axis);
    candidates.told += fmt::format("{}{} with correlation {:.2f} and {:.2f} of its turns",
                                   axis == 0 ? "" : ", ", name(candidate, track.axis_count),
                                   candidate.correlation, candidate.turns_ratio);
    if (candidate.correlation > candidates.best.correlation) candidates.best = candidate;
  }
  return candidates;
}

}  // namespace

std::optional<VerticalAxis> find_vertical_axis(const Track& track) {
  std::string candidates;
  for (const std::int64_t length_ns : kLengths_ns) {
    const std::vector<Turn> turns = turns_of(track, length_ns);
    double total_rad = 0.0;
    for (const Turn& turn : turns) total_rad += std::abs(turn.reference_rad);
    if (total_rad < kLeastTurns_rad) {
      if (candidates.empty()) return std::nullopt;
      break;
    }
    const Candidates found = candidates_of(track, turns);
    if (is_followed(found.best)) return found.best;
    if (candidates.empty()) candidates = found.told;
  }
  throw recording::DataError(fmt::format(
      "no axis of the gyro follows the reference's heading: {}; expected a correlation of 0.7 "
      "and 0.8 to 1.25 of its turns. Name the axis that points up or down with --vertical-axis, "
      "or leave the reference columns out",
      candidates));
}

}  // namespace zerorate::truth
