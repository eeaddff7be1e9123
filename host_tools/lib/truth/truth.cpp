#include "host_tools/lib/truth/truth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "host_tools/lib/truth/delayed.hpp"
#include "host_tools/lib/truth/heading_jumps.hpp"
#include "host_tools/lib/truth/headings_at_stops.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::truth {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t kSecond = 1'000'000'000;

/// Root mean squares of a series over spans of 2 s that stay below walking pace, sorted.
std::vector<double> slow_spans(const Series& speed_m_s) {
  constexpr double kWalkingPace_m_s = 0.5;
  std::vector<double> spans;
  for (std::size_t first = 0, k = 0; k < speed_m_s.size(); first = k) {
    double squares = 0.0;
    double most = 0.0;
    for (; k < speed_m_s.size() && speed_m_s.time_ns(k) < speed_m_s.time_ns(first) + 2 * kSecond;
         ++k) {
      squares += speed_m_s.value(k) * speed_m_s.value(k);
      most = std::max(most, speed_m_s.value(k));
    }
    if (most < kWalkingPace_m_s) {
      spans.push_back(std::sqrt(squares / static_cast<double>(k - first)));
    }
  }
  std::ranges::sort(spans);
  return spans;
}

/// Heading at a time of a stop: interpolated between its neighbours, or else the nearest heading of
/// the stop.
std::optional<double> heading_at_rest(const Series& heading, std::int64_t time_ns,
                                      const Stop& stop) {
  if (const auto between = heading.at(time_ns, 2 * kSecond)) return between;
  std::optional<double> nearest;
  std::int64_t least_ns = std::numeric_limits<std::int64_t>::max();
  for (std::size_t k = heading.first_from(stop.from_ns);
       k < heading.size() && heading.time_ns(k) <= stop.to_ns; ++k) {
    const std::int64_t apart_ns = std::abs(heading.time_ns(k) - time_ns);
    if (apart_ns >= least_ns) continue;
    least_ns = apart_ns;
    nearest = heading.value(k);
  }
  return nearest ? nearest : heading.at(time_ns, heading.longest_interval_ns());
}

/// Root mean square of the heading's change over the stops.
double error_at_stops(const Series& heading_rad, const std::vector<Stop>& stops) {
  const std::int64_t longest_ns = heading_rad.longest_interval_ns();
  double squares = 0.0;
  std::size_t count = 0;
  for (const Stop& stop : stops) {
    const auto first = heading_rad.at(stop.from_ns, longest_ns);
    const auto last = heading_rad.at(stop.to_ns, longest_ns);
    if (!first || !last) continue;
    squares += (*last - *first) * (*last - *first);
    ++count;
  }
  return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : kNan;
}

/// The headings with as many whole turns between two of them as the gyro measured.
Series with_whole_turns(const Track& track, const VerticalAxis& vertical) {
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  const Series& heading = track.heading_rad;
  Series counted;
  double missed_rad = 0.0;
  for (std::size_t k = 0; k < heading.size(); ++k) {
    if (k > 0) {
      const double by_gyro = vertical.sign * track.turn_rad(vertical.axis, k - 1, k);
      const double by_reference = heading.value(k) - heading.value(k - 1);
      missed_rad += kTurn_rad * std::round((by_gyro - by_reference) / kTurn_rad);
    }
    counted.add(heading.time_ns(k), heading.value(k) + missed_rad);
  }
  return counted;
}

void find_drives(const Track& track, Truth& truth) {
  truth.heading_rad = with_whole_turns(track, truth.vertical);
  truth.drives.clear();
  const Series& heading = truth.heading_rad;
  const std::int64_t longest_ns = heading.longest_interval_ns();
  const HeadingJumps jumps{track, heading, truth.vertical};
  for (std::size_t k = 1; k < truth.stops.size(); ++k) {
    const Stop& before = truth.stops[k - 1];
    const Stop& after = truth.stops[k];
    Drive drive{.from_ns = before.middle_ns(),
                .departure_ns = before.to_ns,
                .arrival_ns = after.from_ns,
                .to_ns = after.middle_ns()};
    const auto turned = [&](std::int64_t from_ns, std::int64_t to_ns) -> std::optional<double> {
      const auto first = heading_at_rest(heading, from_ns, before);
      const auto last = heading_at_rest(heading, to_ns, after);
      if (!first || !last) return std::nullopt;
      return *last - *first;
    };
    const auto turn = turned(drive.from_ns, drive.to_ns);
    const auto on_the_way = turned(drive.way_from_ns(), drive.way_to_ns());
    const bool is_watched = !truth.has_headings_at_stops_only;
    if (!turn || !on_the_way ||
        (is_watched && !heading.covers(drive.from_ns, drive.to_ns, longest_ns))) {
      drive.flaw = Flaw::heading_missing;
    } else {
      drive.turn_rad = *turn;
      drive.way_turn_rad = *on_the_way;
      const bool has_jump = is_watched && jumps.has_between(drive.from_ns, drive.to_ns);
      if (has_jump) drive.flaw = Flaw::heading_jump;
    }
    truth.drives.push_back(drive);
  }
}

/// The headings at the times of which they tell, and the gyro's turns at these times.
Track earlier(const Track& track, std::int64_t delay_ns) {
  const Series& heading = track.heading_rad;
  Track moved{.axis_count = track.axis_count, .speed_m_s = track.speed_m_s};
  for (std::size_t k = 0; k < heading.size(); ++k) {
    const std::int64_t at_ns = heading.time_ns(k) - delay_ns;
    const std::size_t next = heading.first_from(at_ns);
    if (next == 0 || next == heading.size()) continue;  // before or behind the gyro's turns
    const double weight = units::seconds(at_ns - heading.time_ns(next - 1)) /
                          units::seconds(heading.time_ns(next) - heading.time_ns(next - 1));
    auto turned_rad = track.turned_rad[next];
    for (std::size_t axis = 0; axis < turned_rad.size(); ++axis) {
      turned_rad[axis] = std::lerp(track.turned_rad[next - 1][axis], turned_rad[axis], weight);
    }
    moved.heading_rad.add(at_ns, heading.value(k));
    moved.turned_rad.push_back(turned_rad);
  }
  return moved;
}

}  // namespace

Truth without_delay(Truth truth, const Track& track, std::int64_t delay_ns) {
  const Track moved = earlier(track, delay_ns);
  const bool is_estimated = truth.reference_error_rad == truth.error_at_stops_rad;
  truth.error_at_stops_rad = error_at_stops(moved.heading_rad, truth.stops);
  if (is_estimated) truth.reference_error_rad = truth.error_at_stops_rad;
  find_drives(moved, truth);
  return truth;
}

VerticalAxis parse_vertical_axis(std::string_view text) {
  const bool is_signed = text.starts_with('-') || text.starts_with('+');
  const std::string_view axis = text.substr(is_signed ? 1 : 0);
  if (axis.size() != 1 || axis[0] < 'x' || axis[0] > 'z') {
    throw std::invalid_argument(
        fmt::format("--vertical-axis: expected x, y, z, -x, -y or -z, found '{}'", text));
  }
  return {.axis = static_cast<std::size_t>(axis[0] - 'x'),
          .sign = text.starts_with('-') ? -1.0 : 1.0};
}

std::string name(const VerticalAxis& vertical, std::size_t axis_count) {
  const std::string axis = axis_count == 1 ? "rate" : std::string(1, "xyz"[vertical.axis]);
  return vertical.sign < 0.0 ? "-" + axis : axis;
}

std::string_view name(Flaw flaw) {
  switch (flaw) {
    case Flaw::none:
      return "none";
    case Flaw::heading_missing:
      return "heading_missing";
    case Flaw::heading_jump:
      return "heading_jump";
    case Flaw::rate_missing:
      return "rate_missing";
    case Flaw::no_bias:
      return "no_bias";
  }
  return "unknown";
}

void find_stops(const Series& speed_m_s, Truth& truth) {
  constexpr double kSigmas = 6.0;
  constexpr double kLeastLimit_m_s = 0.02;
  constexpr double kMostLimit_m_s = 0.3;
  constexpr auto kShortestStop_ns = static_cast<std::int64_t>(kShortestStop_s * 1e9);
  const std::vector<double> spans = slow_spans(speed_m_s);
  truth.speed_noise_m_s = spans.empty() ? kNan : spans[spans.size() / 4];
  truth.speed_limit_m_s =
      spans.empty() ? kLeastLimit_m_s
                    : std::clamp(kSigmas * truth.speed_noise_m_s, kLeastLimit_m_s, kMostLimit_m_s);
  const std::int64_t longest_ns = speed_m_s.longest_interval_ns();
  Stop stop;
  bool is_open = false;
  const auto close = [&] {
    if (is_open && stop.to_ns - stop.from_ns >= kShortestStop_ns) truth.stops.push_back(stop);
    is_open = false;
  };
  for (std::size_t k = 0; k < speed_m_s.size(); ++k) {
    const std::int64_t at_ns = speed_m_s.time_ns(k);
    if (is_open && at_ns - stop.to_ns > longest_ns) close();
    if (speed_m_s.value(k) > truth.speed_limit_m_s) {
      close();
      continue;
    }
    if (!is_open) stop.from_ns = at_ns;
    stop.to_ns = at_ns;
    is_open = true;
  }
  close();
}

Truth find_truth(const Track& track, const TruthOptions& options) {
  Truth truth{.heading_rad = track.heading_rad};
  find_stops(track.speed_m_s, truth);
  if (track.speed_m_s.size() > 0) {
    const auto usable_ns = static_cast<std::int64_t>(options.usable_from_s * 1e9);
    std::erase_if(truth.stops, [&](const Stop& stop) { return stop.to_ns < usable_ns; });
  }
  truth.has_headings_at_stops_only = are_at_stops(track, truth);
  if (truth.has_headings_at_stops_only) keep_stops_with_heading(track.heading_rad, truth.stops);
  truth.error_at_stops_rad = error_at_stops(track.heading_rad, truth.stops);
  truth.reference_error_rad = options.reference_error_rad.value_or(
      std::isfinite(truth.error_at_stops_rad) ? truth.error_at_stops_rad : 0.0);
  if (track.speed_m_s.size() == 0) {
    truth.obstacle = "the true stops need the column ref_speed_mps";
  } else if (track.heading_rad.size() == 0) {
    truth.obstacle = "the true turns need the column ref_heading_deg or ref_rate_dps";
  } else if (truth.stops.size() < 2) {
    truth.obstacle = fmt::format(
        "the reference has {} stop{} below {:.2g} m/s for {:g} s, and a drive needs two",
        truth.stops.size(), truth.stops.size() == 1 ? "" : "s", truth.speed_limit_m_s,
        kShortestStop_s);
  }
  if (!truth.obstacle.empty()) return truth;
  std::optional<Track> corrected;
  if (truth.has_headings_at_stops_only) corrected = without_bias(track, truth.stops);
  const Track& used = corrected ? *corrected : track;
  const auto vertical = options.vertical ? options.vertical
                        : corrected      ? axis_of_net_turns(used)
                                         : find_vertical_axis(used);
  if (!vertical) {
    truth.obstacle =
        "the reference turns by less than 30 deg, which does not determine the vertical axis; name "
        "it "
        "with --vertical-axis";
    return truth;
  }
  if (vertical->axis >= track.axis_count) {
    throw std::invalid_argument("--vertical-axis: the recording has one axis, x");
  }
  truth.vertical = *vertical;
  find_drives(used, truth);
  return truth;
}

std::optional<Truth> read_truth(recording::Reader& reader, const TruthOptions& options) {
  const recording::Columns& columns = reader.columns();
  if (!columns.ref_heading && !columns.ref_rate && !columns.ref_speed) return std::nullopt;
  return find_truth(read_track(reader), options);
}

}  // namespace zerorate::truth
