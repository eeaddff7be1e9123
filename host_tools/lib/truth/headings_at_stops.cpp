#include "host_tools/lib/truth/headings_at_stops.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "host_tools/lib/units/units.hpp"

namespace zerorate::truth {
namespace {

/// Time beside a stop in which a heading still belongs to it: the vehicle begins to roll.
constexpr std::int64_t kBesideStop_ns = 1'000'000'000;

using Rates = std::array<double, recording::kMaxAxes>;

bool has_heading(const Series& heading_rad, const Stop& stop) {
  const std::size_t first = heading_rad.first_from(stop.from_ns);
  return first < heading_rad.size() && heading_rad.time_ns(first) <= stop.to_ns;
}

/// Rates of the gyro between the first and the last heading of a stop; zero where there is one.
Rates bias_at(const Stop& stop, const Track& track) {
  const std::size_t first = track.heading_rad.first_from(stop.from_ns);
  const std::size_t last = track.heading_rad.first_from(stop.to_ns + 1) - 1;
  const double length_s =
      units::seconds(track.heading_rad.time_ns(last) - track.heading_rad.time_ns(first));
  Rates bias{};
  for (std::size_t axis = 0; axis < track.axis_count && length_s > 0.0; ++axis) {
    bias[axis] = track.turn_rad(axis, first, last) / length_s;
  }
  return bias;
}

double sum_of_turns(const Track& track, std::size_t axis) {
  double sum_rad = 0.0;
  for (std::size_t k = 1; k < track.turned_rad.size(); ++k)
    sum_rad += std::abs(track.turn_rad(axis, k - 1, k));
  return sum_rad;
}

/// Sum of the squares by which turns in a sense and headings differ, but for whole turns.
double misfit(const Track& track, const VerticalAxis& vertical) {
  double squares = 0.0;
  for (std::size_t k = 1; k < track.turned_rad.size(); ++k) {
    const double by_reference = track.heading_rad.value(k) - track.heading_rad.value(k - 1);
    const double apart_rad =
        std::remainder(vertical.sign * track.turn_rad(vertical.axis, k - 1, k) - by_reference,
                       2.0 * std::numbers::pi);
    squares += apart_rad * apart_rad;
  }
  return squares;
}

}  // namespace

bool are_at_stops(const Track& track, const Truth& truth) {
  const Series& headings = track.heading_rad;
  const std::int64_t longest_ns = track.speed_m_s.longest_interval_ns();
  const auto stands = [&](std::size_t k) {
    const std::int64_t at_ns = headings.time_ns(k);
    const auto speed_m_s = track.speed_m_s.at(at_ns, longest_ns);
    if (speed_m_s && *speed_m_s <= truth.speed_limit_m_s) return true;
    return std::ranges::any_of(truth.stops, [&](const Stop& stop) {
      return at_ns >= stop.from_ns - kBesideStop_ns && at_ns <= stop.to_ns + kBesideStop_ns;
    });
  };
  for (std::size_t k = 0; k < headings.size(); ++k) {
    if (!stands(k)) return false;
  }
  return std::ranges::count_if(truth.stops,
                               [&](const Stop& stop) { return has_heading(headings, stop); }) >= 2;
}

void keep_stops_with_heading(const Series& heading_rad, std::vector<Stop>& stops) {
  std::erase_if(stops, [&](const Stop& stop) { return !has_heading(heading_rad, stop); });
}

Track without_bias(const Track& track, const std::vector<Stop>& stops) {
  Track corrected = track;
  Rates taken_off_rad{};
  std::size_t stop = 0;
  Rates bias = bias_at(stops.front(), track);
  for (std::size_t k = 1; k < track.turned_rad.size(); ++k) {
    Rates rate = bias;
    const bool is_at_next = stop + 1 < stops.size() && track.heading_rad.time_ns(k) >=
                                                           stops[stop + 1].from_ns - kBesideStop_ns;
    if (is_at_next) {
      ++stop;
      bias = bias_at(stops[stop], track);
      for (std::size_t axis = 0; axis < rate.size(); ++axis)
        rate[axis] = 0.5 * (rate[axis] + bias[axis]);
    }
    const double elapsed_s =
        units::seconds(track.heading_rad.time_ns(k) - track.heading_rad.time_ns(k - 1));
    for (std::size_t axis = 0; axis < rate.size(); ++axis) {
      taken_off_rad[axis] += rate[axis] * elapsed_s;
      corrected.turned_rad[k][axis] -= taken_off_rad[axis];
    }
  }
  return corrected;
}

std::optional<VerticalAxis> axis_of_net_turns(const Track& track) {
  VerticalAxis vertical{.axis = 0};
  double most_rad = 0.0;
  for (std::size_t axis = 0; axis < track.axis_count; ++axis) {
    const double turns_rad = sum_of_turns(track, axis);
    if (turns_rad <= most_rad) continue;
    most_rad = turns_rad;
    vertical.axis = axis;
  }
  if (!(most_rad > kLeastTurns_rad)) return std::nullopt;
  VerticalAxis opposite = vertical;
  opposite.sign = -1.0;
  return misfit(track, opposite) < 0.5 * misfit(track, vertical) ? opposite : vertical;
}

}  // namespace zerorate::truth
