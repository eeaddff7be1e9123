#include "host_tools/lib/odometry/odometer_figures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/recording/json.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::odometry {
namespace {

constexpr double kShortestStop_s = 2.0;
constexpr double kHardBraking_m_s2 = 1.3;

Sample sample_of(std::vector<double> values, std::string_view what) {
  Sample sample{.sorted = std::move(values), .median = {}};
  std::ranges::sort(sample.sorted);
  if (sample.sorted.empty()) return sample;
  const auto median = [&](const std::vector<std::size_t>& indices) {
    std::vector<double> drawn;
    drawn.reserve(indices.size());
    for (const std::size_t index : indices) drawn.push_back(sample.sorted[index]);
    std::ranges::sort(drawn);
    return statistics::quantile_of_sorted(drawn, 0.5);
  };
  sample.median = statistics::bootstrap(sample.sorted.size(), median,
                                        random::RandomStream{1}.substream(what), {.draws = 1000});
  return sample;
}

/// Speeds that the odometer shows in two rows next to each other, in increasing order, each once.
std::vector<double> held_speeds(const SpeedRecord& record) {
  constexpr double kAlike_m_s = 1e-3;
  std::vector<double> held;
  for (std::size_t row = 1; row < record.size(); ++row) {
    const double speed = record.odometer_m_s[row];
    if (speed > 0.0 && std::abs(speed - record.odometer_m_s[row - 1]) < kAlike_m_s) {
      held.push_back(speed);
    }
  }
  std::ranges::sort(held);
  const auto alike = [=](double a, double b) { return std::abs(a - b) < kAlike_m_s; };
  held.erase(std::unique(held.begin(), held.end(), alike), held.end());
  return held;
}

void measure_speeds(const SpeedRecord& record, OdometerFigures& figures) {
  const std::vector<double> held = held_speeds(record);
  if (record.counts_pulses || held.size() < 3) return;
  figures.smallest_m_s = held.front();
  std::vector<double> steps;
  for (std::size_t i = 1; i < held.size(); ++i) steps.push_back(held[i] - held[i - 1]);
  figures.step_m_s = statistics::median_of(std::move(steps));
}

/// Slope of the reference over a span around or beside a row [m/s2].
double slope(const SpeedRecord& record, std::size_t from, std::size_t to) {
  return (record.reference_m_s[to] - record.reference_m_s[from]) /
         (record.time_s[to] - record.time_s[from]);
}

bool is_whole(const SpeedRecord& record, std::size_t from, std::size_t to) {
  const auto gap = std::ranges::upper_bound(record.gap_before, from);
  return gap == record.gap_before.end() || *gap > to;
}

std::size_t rows_in(const SpeedRecord& record, double span_s) {
  return std::max<std::size_t>(1,
                               static_cast<std::size_t>(std::lround(span_s / record.period_s())));
}

/// Acceleration over a second around each row but the outermost; NaN beside a gap.
std::vector<double> accelerations(const SpeedRecord& record) {
  const std::size_t half = rows_in(record, 0.5);
  std::vector<double> acceleration(record.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t row = half; row + half < record.size(); ++row) {
    if (is_whole(record, row - half, row + half)) {
      acceleration[row] = slope(record, row - half, row + half);
    }
  }
  return acceleration;
}

Sample measure_renewal(const SpeedRecord& record, const std::vector<double>& acceleration) {
  constexpr double kSlowest_m_s = 2.0;
  std::vector<double> intervals;
  for (const Stretch& rows : stretches(record, [&](std::size_t row) {
         return std::abs(acceleration[row]) > kHardBraking_m_s2 &&
                record.odometer_m_s[row] > kSlowest_m_s;
       })) {
    std::optional<std::size_t> newest;
    for (std::size_t row = rows.begin + 1; row < rows.end; ++row) {
      if (std::abs(record.odometer_m_s[row] - record.odometer_m_s[row - 1]) < 1e-3) continue;
      if (newest) intervals.push_back(record.time_s[row] - record.time_s[*newest]);
      newest = row;
    }
  }
  return sample_of(std::move(intervals), "renewal");
}

BootstrapFigure measure_scale(const SpeedRecord& record) {
  constexpr double kSlowest_m_s = 3.0;
  std::vector<std::pair<double, double>> drives;  // odometer times reference, reference squared
  for (const Stretch& rows : stretches(
           record, [&](std::size_t row) { return record.reference_m_s[row] > kSlowest_m_s; })) {
    auto& [product, square] = drives.emplace_back(0.0, 0.0);
    for (std::size_t row = rows.begin; row < rows.end; ++row) {
      product += record.odometer_m_s[row] * record.reference_m_s[row];
      square += std::pow(record.reference_m_s[row], 2);
    }
  }
  if (drives.empty()) return {};
  const auto ratio = [&](const std::vector<std::size_t>& indices) {
    double product = 0.0;
    double square = 0.0;
    for (const std::size_t index : indices) {
      product += drives[index].first;
      square += drives[index].second;
    }
    return product / square;
  };
  return statistics::bootstrap(drives.size(), ratio, random::RandomStream{1}.substream("scale"),
                               {.draws = 1000});
}

/// Time from the reference's last row at or above a speed until a row; nothing across a gap.
std::optional<double> time_below(const SpeedRecord& record, double speed_m_s, std::size_t row) {
  for (std::size_t k = row; k-- > 0;) {
    if (!is_whole(record, k, row)) return std::nullopt;
    if (record.reference_m_s[k] >= speed_m_s) return record.time_s[row] - record.time_s[k];
  }
  return std::nullopt;
}

void measure_ends(const SpeedRecord& record, const std::vector<Silence>& silences,
                  OdometerFigures& figures) {
  std::vector<double> leaves;
  std::vector<double> reaches;
  std::vector<double> holds;
  for (const Silence& silence : silences) {
    const Stretch& rows = silence.rows;
    if (rows.has_end) leaves.push_back(record.reference_m_s[rows.end]);
    if (!rows.has_begin) continue;
    reaches.push_back(record.reference_m_s[rows.begin]);
    if (!figures.smallest_m_s) continue;
    if (const auto held = time_below(record, *figures.smallest_m_s, rows.begin)) {
      holds.push_back(*held);
    }
  }
  figures.leaves_zero_m_s = sample_of(std::move(leaves), "leaves");
  figures.reaches_zero_m_s = sample_of(std::move(reaches), "reaches");
  figures.holds_s = sample_of(std::move(holds), "holds");
}

struct StopsAndDrives {
  std::vector<Stretch> stops;
  std::vector<double> stops_s;
  std::vector<double> drives_s;
};

/// Stops of at least kShortestStop_s; a drive lies between two of them, without a gap.
StopsAndDrives divide(const SpeedRecord& record,
                      const std::function<bool(std::size_t)>& is_at_rest) {
  StopsAndDrives found;
  for (const Stretch& rows : stretches(record, is_at_rest)) {
    const double length_s = record.time_s[rows.end - 1] - record.time_s[rows.begin];
    if (length_s < kShortestStop_s) continue;
    if (!found.stops.empty() && is_whole(record, found.stops.back().end - 1, rows.begin)) {
      found.drives_s.push_back(record.time_s[rows.begin] -
                               record.time_s[found.stops.back().end - 1]);
    }
    found.stops.push_back(rows);
    if (rows.is_whole()) found.stops_s.push_back(length_s);
  }
  return found;
}

void measure_driver(const SpeedRecord& record, OdometerFigures& figures) {
  StopsAndDrives truth = divide(record, [&](std::size_t row) { return record.stands(row); });
  StopsAndDrives shown = divide(record, [&](std::size_t row) { return record.is_silent(row); });
  const std::size_t span = rows_in(record, 2.0);
  std::vector<double> braking;
  std::vector<double> pulling_away;
  for (const Stretch& stop : truth.stops) {
    if (stop.has_begin && stop.begin >= span && is_whole(record, stop.begin - span, stop.begin)) {
      braking.push_back(slope(record, stop.begin - span, stop.begin));
    }
    if (stop.has_end && stop.end + span <= record.size() &&
        is_whole(record, stop.end - 1, stop.end - 1 + span)) {
      pulling_away.push_back(slope(record, stop.end - 1, stop.end - 1 + span));
    }
  }
  figures.true_stops_s = sample_of(std::move(truth.stops_s), "true stops");
  figures.odometer_stops_s = sample_of(std::move(shown.stops_s), "odometer stops");
  figures.true_drives_s = sample_of(std::move(truth.drives_s), "true drives");
  figures.odometer_drives_s = sample_of(std::move(shown.drives_s), "odometer drives");
  figures.braking_m_s2 = sample_of(std::move(braking), "braking");
  figures.pulling_away_m_s2 = sample_of(std::move(pulling_away), "pulling away");
}

void measure_turning_at_rest(const SpeedRecord& record, OdometerFigures& figures) {
  if (record.yaw_rad_s.empty()) return;
  for (std::size_t row = 0; row < record.size(); ++row) {
    if (record.stands(row) && record.is_silent(row)) {
      figures.standing_turning_rad_s.push_back(std::abs(record.yaw_rad_s[row]));
    }
  }
  std::ranges::sort(figures.standing_turning_rad_s);
}

}  // namespace

OdometerFigures measure_odometer(const SpeedRecord& record) {
  OdometerFigures figures{.rows_s = record.period_s(),
                          .duration_s = record.time_s.back() - record.time_s.front()};
  const std::vector<Silence> silences = find_silences(record);
  for (const Silence& silence : silences) {
    figures.silent_share +=
        static_cast<double>(silence.rows.size()) / static_cast<double>(record.size());
  }
  measure_speeds(record, figures);
  std::vector<double> acceleration = accelerations(record);
  figures.renewal_s = measure_renewal(record, acceleration);
  figures.latency_s = measure_latency(record);
  figures.scale = measure_scale(record);
  measure_ends(record, silences, figures);
  figures.rolling = describe_rolling(record, silences, std::nullopt);
  for (std::size_t i = 0; i < kSituations.size(); ++i) {
    figures.rolling_by_situation[i] = describe_rolling(record, silences, kSituations[i]);
  }
  measure_turning_at_rest(record, figures);
  measure_driver(record, figures);
  for (std::size_t row = 0; row < record.size(); ++row) {
    if (record.reference_m_s[row] > 1.0 && std::isfinite(acceleration[row])) {
      figures.accelerations_m_s2.push_back(acceleration[row]);
    }
  }
  std::ranges::sort(figures.accelerations_m_s2);
  return figures;
}

namespace {

using Json = nlohmann::ordered_json;
using recording::number;

Json interval(const BootstrapFigure& figure) {
  return {
      {"value", number(figure.value)}, {"lo95", number(figure.lo)}, {"hi95", number(figure.hi)}};
}

Json optional_number(const std::optional<double>& value) {
  return value ? number(*value) : Json(nullptr);
}

/// Quantiles at 0, 0.05, ... 1.
Json quantiles(std::span<const double> sorted, double unit = 1.0) {
  Json json = Json::array();
  if (sorted.empty()) return json;
  for (int i = 0; i <= 20; ++i) {
    json.push_back(number(statistics::quantile_of_sorted(sorted, i / 20.0) * unit));
  }
  return json;
}

Json sample(const Sample& values) {
  return {{"count", values.sorted.size()},
          {"median", interval(values.median)},
          {"quantiles", quantiles(values.sorted)}};
}

Json rolling_json(const Rolling& rolling) {
  return {{"rows", rolling.rows},
          {"share", interval(rolling.share)},
          {"speed_mps", quantiles(rolling.speeds_m_s)},
          {"turning_dps", quantiles(rolling.turning_rad_s, units::kDegPerRad)}};
}

}  // namespace

std::string to_json(const SpeedRecord& record, const OdometerFigures& figures) {
  Json json{
      {"schema", "zerorate.odometer/1"},
      {"recording", record.name},
      {"rows", record.size()},
      {"rows_lost", record.rows_lost},
      {"gaps", record.gap_before.size()},
      {"period_s", figures.rows_s},
      {"duration_s", figures.duration_s},
      {"metres_per_pulse", record.counts_pulses ? number(record.metres_per_pulse) : Json(nullptr)},
      {"smallest_mps", optional_number(figures.smallest_m_s)},
      {"step_mps", optional_number(figures.step_m_s)},
      {"leaves_zero_mps", sample(figures.leaves_zero_m_s)},
      {"reaches_zero_mps", sample(figures.reaches_zero_m_s)},
      {"holds_s", sample(figures.holds_s)},
      {"renewal_s", sample(figures.renewal_s)},
      {"latency_s", interval(figures.latency_s)},
      {"scale", interval(figures.scale)},
      {"silent_share", figures.silent_share},
      {"rolling", rolling_json(figures.rolling)},
      {"rolling_by_situation", Json::object()}};
  for (std::size_t i = 0; i < kSituations.size(); ++i) {
    json["rolling_by_situation"][name(kSituations[i])] =
        rolling_json(figures.rolling_by_situation[i]);
  }
  json["standing_turning_dps"] = quantiles(figures.standing_turning_rad_s, units::kDegPerRad);
  json["true_stops_s"] = sample(figures.true_stops_s);
  json["odometer_stops_s"] = sample(figures.odometer_stops_s);
  json["true_drives_s"] = sample(figures.true_drives_s);
  json["odometer_drives_s"] = sample(figures.odometer_drives_s);
  json["acceleration_mps2"] = quantiles(figures.accelerations_m_s2);
  json["braking_mps2"] = sample(figures.braking_m_s2);
  json["pulling_away_mps2"] = sample(figures.pulling_away_m_s2);
  return json.dump(2) + "\n";
}

}  // namespace zerorate::odometry
