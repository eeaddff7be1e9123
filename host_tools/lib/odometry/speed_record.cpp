#include "host_tools/lib/odometry/speed_record.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "host_tools/lib/recording/byte_source.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/fields.hpp"
#include "host_tools/lib/recording/number.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::odometry {
namespace {

using recording::Error;

/// Place of each wanted column in a line.
struct Layout {
  std::vector<std::string> names;

  [[nodiscard]] std::optional<std::size_t> find(std::string_view name) const {
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) return std::nullopt;
    return static_cast<std::size_t>(found - names.begin());
  }
  [[nodiscard]] std::optional<std::size_t> find_first(
      std::initializer_list<std::string_view> candidates) const {
    for (const std::string_view name : candidates) {
      if (const auto found = find(name)) return found;
    }
    return std::nullopt;
  }
};

struct WantedColumns {
  std::size_t time = 0;
  std::size_t reference = 0;
  std::size_t odometer = 0;
  std::optional<std::size_t> yaw;
  bool yaw_has_bias = false;
  bool counts_pulses = false;
};

Layout read_header(recording::LineReader& lines) {
  std::string_view line;
  while (lines.next(line)) {
    if (line.empty() || line.starts_with('#')) continue;
    Layout layout;
    for (recording::Fields fields{line}; fields.next();) layout.names.emplace_back(fields.text());
    return layout;
  }
  throw Error{lines.place(), "an empty file", "a header line and samples",
              "Check that this is the right file."};
}

std::size_t require(const recording::LineReader& lines, std::optional<std::size_t> found,
                    std::string expected, std::string mend) {
  if (found) return *found;
  throw Error{lines.place(), "no such column", std::move(expected), std::move(mend)};
}

WantedColumns choose(const recording::LineReader& lines, const Layout& layout) {
  WantedColumns wanted;
  wanted.time = require(lines, layout.find_first({"t_s", "time_s"}),
                        "a time column named t_s or time_s (seconds)", "Add or rename it.");
  wanted.reference = require(
      lines, layout.find("ref_speed_mps"), "the speed by a reference, ref_speed_mps (m/s)",
      "An odometer is measured against a better speed, e.g. of a satellite receiver: add it.");
  const auto speed = layout.find_first({"odometer_speed_mps", "obd_speed_mps"});
  wanted.counts_pulses = !speed;
  wanted.odometer = require(lines, speed ? speed : layout.find("odometer_pulses"),
                            "odometer_speed_mps or obd_speed_mps (m/s), or odometer_pulses",
                            "Add the odometer's speed or its pulse count.");
  wanted.yaw = layout.find("ref_rate_dps");
  wanted.yaw_has_bias = !wanted.yaw;
  if (!wanted.yaw) wanted.yaw = layout.find("gz_dps");
  return wanted;
}

std::vector<double> parse(const recording::LineReader& lines, std::string_view line,
                          const Layout& layout) {
  std::vector<double> values;
  for (recording::Fields fields{line}; fields.next();) {
    const auto value = recording::parse_real(fields.text());
    if (!value) {
      throw Error{lines.place(fields.column()), recording::excerpt(fields.text()), "a number",
                  "Leave the cell empty if the value was lost."};
    }
    values.push_back(*value);
  }
  if (values.size() != layout.names.size()) {
    throw Error{lines.place(), std::to_string(values.size()) + " fields",
                "as many as the header names, " + std::to_string(layout.names.size()),
                "Complete or remove the line."};
  }
  return values;
}

/// Speed by the spacing of the rows in which pulses came: a silence of kSilent_s is zero.
std::vector<double> speed_of_pulses(const SpeedRecord& record, const std::vector<double>& pulses) {
  std::vector<double> speed(pulses.size(), 0.0);
  std::size_t newest = 0;
  for (std::size_t row = 1; row < pulses.size(); ++row) {
    if (pulses[row] == pulses[row - 1]) continue;
    const double apart_s = record.time_s[row] - record.time_s[newest];
    if (apart_s <= kSilent_s) {
      const double metres = record.metres_per_pulse * (pulses[row] - pulses[newest]);
      std::fill(speed.begin() + static_cast<std::ptrdiff_t>(newest) + 1,
                speed.begin() + static_cast<std::ptrdiff_t>(row) + 1, std::abs(metres) / apart_s);
    } else {
      speed[row] = record.metres_per_pulse / apart_s;  // the first pulse after a silence
    }
    newest = row;
  }
  return speed;
}

double reference_distance_m(const SpeedRecord& record) {
  double distance_m = 0.0;
  for (std::size_t row = 1; row < record.size(); ++row) {
    if (std::ranges::binary_search(record.gap_before, row)) continue;
    distance_m += 0.5 * (record.reference_m_s[row] + record.reference_m_s[row - 1]) *
                  (record.time_s[row] - record.time_s[row - 1]);
  }
  return distance_m;
}

/// Pulses of all rows but those after a gap.
double counted_pulses(const SpeedRecord& record, const std::vector<double>& pulses) {
  double counted = 0.0;
  for (std::size_t row = 1; row < pulses.size(); ++row) {
    if (!std::ranges::binary_search(record.gap_before, row)) {
      counted += pulses[row] - pulses[row - 1];
    }
  }
  return counted;
}

void find_gaps(SpeedRecord& record) {
  const double longest_s = 10.0 * record.period_s();
  for (std::size_t row = 1; row < record.size(); ++row) {
    if (record.time_s[row] - record.time_s[row - 1] > longest_s) record.gap_before.push_back(row);
  }
}

void take_bias_off(SpeedRecord& record) {
  std::vector<double> at_rest;
  for (std::size_t row = 0; row < record.size(); ++row) {
    if (record.stands(row)) at_rest.push_back(record.yaw_rad_s[row]);
  }
  if (at_rest.empty()) throw recording::DataError{record.name + ": the vehicle never stands"};
  const double bias = statistics::median_of(std::move(at_rest));
  for (double& rate : record.yaw_rad_s) rate -= bias;
}

}  // namespace

double SpeedRecord::period_s() const {
  std::vector<double> intervals;
  for (std::size_t row = 1; row < size(); ++row) intervals.push_back(time_s[row] - time_s[row - 1]);
  return statistics::median_of(std::move(intervals));
}

SpeedRecord read_speed_record(const std::filesystem::path& path) {
  recording::LineReader lines{path};
  const Layout layout = read_header(lines);
  const WantedColumns wanted = choose(lines, layout);
  SpeedRecord record{.name = path.filename().string(), .counts_pulses = wanted.counts_pulses};
  for (std::string_view line; lines.next(line);) {
    if (line.empty()) continue;
    const std::vector<double> values = parse(lines, line, layout);
    const double yaw_rad_s = wanted.yaw ? values[*wanted.yaw] * units::kRadPerDeg : 0.0;
    const std::array needed{values[wanted.time], values[wanted.reference], values[wanted.odometer],
                            yaw_rad_s};
    if (!std::ranges::all_of(needed, [](double value) { return std::isfinite(value); })) {
      ++record.rows_lost;
      continue;
    }
    if (record.size() > 0 && needed[0] <= record.time_s.back()) {
      throw Error{lines.place(), "a time that is not later than the one before",
                  "times that increase", "Sort the rows, and remove duplicates."};
    }
    record.time_s.push_back(needed[0]);
    record.reference_m_s.push_back(std::abs(needed[1]));
    record.odometer_m_s.push_back(wanted.counts_pulses ? needed[2] : std::abs(needed[2]));
    if (wanted.yaw) record.yaw_rad_s.push_back(yaw_rad_s);
  }
  if (record.size() < 100) {
    throw recording::DataError{record.name + ": fewer than a hundred rows with both speeds"};
  }
  find_gaps(record);
  if (wanted.counts_pulses) {
    const double counted = counted_pulses(record, record.odometer_m_s);
    if (!(counted > 0.0)) throw recording::DataError{record.name + ": the odometer counts nothing"};
    record.metres_per_pulse = reference_distance_m(record) / counted;
    record.odometer_m_s = speed_of_pulses(record, record.odometer_m_s);
  }
  if (wanted.yaw && wanted.yaw_has_bias) take_bias_off(record);
  return record;
}

std::vector<Stretch> stretches(const SpeedRecord& record,
                               const std::function<bool(std::size_t)>& has_property) {
  std::vector<Stretch> found;
  const auto is_after_gap = [&](std::size_t row) {
    return std::ranges::binary_search(record.gap_before, row);
  };
  bool was_inside = false;
  for (std::size_t row = 0; row < record.size(); ++row) {
    const bool has = has_property(row);
    const bool is_cut = row == 0 || is_after_gap(row);
    if (was_inside && (is_cut || !has)) {
      found.back().end = row;
      found.back().has_end = !is_cut;
      was_inside = false;
    }
    if (has && !was_inside) {
      found.push_back({.begin = row, .end = record.size(), .has_begin = !is_cut, .has_end = false});
    }
    was_inside = has;
  }
  return found;
}

}  // namespace zerorate::odometry
