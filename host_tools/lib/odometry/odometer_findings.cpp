#include "host_tools/lib/odometry/odometer_findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <string_view>
#include <utility>

#include "host_tools/lib/odometry/odometer_figures.hpp"
#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::odometry {
namespace {

constexpr double kDriving_m_s = 2.0;  ///< above the dead band of any odometer that is in use
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

BootstrapFigure single(double value) {
  return {value, kNan, kNan};
}

BootstrapFigure mean_of(const std::vector<double>& values, std::string_view name) {
  if (values.size() < 3) return {};
  return statistics::bootstrap(
      values.size(),
      [&](const std::vector<std::size_t>& indices) {
        double sum = 0.0;
        for (const std::size_t index : indices) sum += values[index];
        return sum / static_cast<double>(indices.size());
      },
      random::RandomStream{1}.substream(name));
}

bool is_driving(const SpeedRecord& record, std::size_t row) {
  return record.reference_m_s[row] > std::max(kDriving_m_s, 4.0 * record.metres_per_pulse);
}

double row_m(const SpeedRecord& record, std::size_t row) {
  if (row == 0 || std::ranges::binary_search(record.gap_before, row)) return 0.0;
  return record.reference_m_s[row] * (record.time_s[row] - record.time_s[row - 1]);
}

/// Silences in which the sensor did not die: the vehicle is never at driving speed.
std::vector<Silence> silences_of_stops(const SpeedRecord& record) {
  std::vector<Silence> silences = find_silences(record);
  std::erase_if(silences, [&](const Silence& silence) {
    const bool stands = silence.rows.size() > silence.rolling.size();
    return !stands || std::ranges::any_of(silence.rolling, [&](const RollingRow& rolling) {
      return is_driving(record, rolling.row);
    });
  });
  return silences;
}

/// Metres that a vehicle rolls in each silence, beyond a pulse in each situation.
std::vector<double> excess_m(const SpeedRecord& record, const std::vector<Silence>& silences,
                             std::initializer_list<Situation> situations) {
  std::vector<double> excess;
  for (const Silence& silence : silences) {
    std::array<double, kSituations.size()> rolled_m{};
    for (const RollingRow& rolling : silence.rolling) {
      rolled_m[static_cast<std::size_t>(rolling.situation)] += row_m(record, rolling.row);
    }
    excess.push_back(0.0);
    for (const Situation situation : situations) {
      excess.back() +=
          std::max(0.0, rolled_m[static_cast<std::size_t>(situation)] - record.metres_per_pulse);
    }
  }
  return excess;
}

/// Whether more is rolled than the noise of the reference at rest may feign.
bool is_rolled(const BootstrapFigure& metres) {
  constexpr double kLeast_m = 0.02;
  return metres.lo > kLeast_m;
}

void find_motion(const SpeedRecord& record, std::vector<OdometerFinding>& findings) {
  const std::vector<Silence> silences = silences_of_stops(record);
  const BootstrapFigure rolled_m =
      mean_of(excess_m(record, silences,
                       {Situation::before_stop, Situation::after_stop, Situation::inching}),
              "rolled");
  if (!is_rolled(rolled_m)) return;
  const Rolling rolling = describe_rolling(record, silences, std::nullopt);
  const auto quantile = [](const std::vector<double>& sorted, double share, double unit) {
    return single(sorted.empty() ? kNan : unit * statistics::quantile_of_sorted(sorted, share));
  };
  OdometerFinding motion{.name = "motion_in_stops",
                         .sentence = fmt::format("In {:.1f} % of the time in which the odometer "
                                                 "reports that it stands, the vehicle rolls: "
                                                 "{:.2f} m a stop beyond what its pulses explain.",
                                                 100.0 * rolling.share.value, rolled_m.value),
                         .figures = {{"share", rolling.share},
                                     {"rolled_m_per_stop", rolled_m},
                                     {"speed_median_mps", quantile(rolling.speeds_m_s, 0.5, 1.0)},
                                     {"speed_most_mps", quantile(rolling.speeds_m_s, 1.0, 1.0)}}};
  if (!rolling.turning_rad_s.empty()) {
    motion.figures.push_back(
        {"turning_median_dps", quantile(rolling.turning_rad_s, 0.5, units::kDegPerRad)});
    motion.figures.push_back(
        {"turning_95_percent_dps", quantile(rolling.turning_rad_s, 0.95, units::kDegPerRad)});
  }
  findings.push_back(std::move(motion));
}

/// Speed below which the odometer is silent: it leaves zero there, later by its latency.
BootstrapFigure dead_band_of(const OdometerFigures& figures) {
  const BootstrapFigure& leaves = figures.leaves_zero_m_s.median;
  const double acceleration = figures.pulling_away_m_s2.median.value;
  const BootstrapFigure& latency = figures.latency_s;
  return {leaves.value - acceleration * latency.value, leaves.lo - acceleration * latency.hi,
          leaves.hi - acceleration * latency.lo};
}

void find_dead_band(const SpeedRecord& record, const OdometerFigures& figures,
                    std::vector<OdometerFinding>& findings) {
  const BootstrapFigure band = dead_band_of(figures);
  // A vehicle gathers speed unseen until the first pulse, half of one away in the median, and until
  // the next row.
  const double acceleration = figures.pulling_away_m_s2.median.hi;
  const double healthy_m_s =
      std::sqrt(acceleration * record.metres_per_pulse) + acceleration * figures.rows_s;
  // A late odometer is silent too late: whoever is silent before the stop has a dead band.
  const std::vector<Silence> silences = silences_of_stops(record);
  const BootstrapFigure before_m =
      mean_of(excess_m(record, silences, {Situation::before_stop}), "before");
  if (!(band.lo > healthy_m_s) && !is_rolled(before_m)) return;
  findings.push_back(
      {.name = "odometer_dead_band",
       .sentence = fmt::format("Below about {:.2g} m/s the odometer reads 0.", band.value),
       .figures = {{"dead_band_mps", band}}});
}

void find_latency(const OdometerFigures& figures, std::vector<OdometerFinding>& findings) {
  constexpr double kLeast_s = 0.1;
  if (!(figures.latency_s.lo > std::max(kLeast_s, figures.rows_s))) return;
  findings.push_back(
      {.name = "odometer_late",
       .sentence = fmt::format("The odometer is late by {:.2f} s: the vehicle already moves, and "
                               "still stands by the odometer.",
                               figures.latency_s.value),
       .figures = {{"latency_s", figures.latency_s}}});
}

/// Odometer's distance over the reference's in spans of 10 s at driving speed.
std::vector<double> span_ratios(const SpeedRecord& record) {
  constexpr double kSpan_s = 10.0;
  std::vector<double> ratios;
  std::size_t first = 0;
  double reference_m = 0.0;
  double odometer_m = 0.0;
  for (std::size_t row = 1; row < record.size(); ++row) {
    if (!is_driving(record, row) || std::ranges::binary_search(record.gap_before, row)) {
      first = row;
      reference_m = odometer_m = 0.0;
      continue;
    }
    reference_m += row_m(record, row);
    odometer_m += record.odometer_m_s[row] * (record.time_s[row] - record.time_s[row - 1]);
    if (record.time_s[row] - record.time_s[first] < kSpan_s) continue;
    ratios.push_back(odometer_m / reference_m);
    first = row;
    reference_m = odometer_m = 0.0;
  }
  return ratios;
}

void find_double_counting(const SpeedRecord& record, std::vector<OdometerFinding>& findings) {
  constexpr double kMost = 1.5;
  const std::vector<double> ratios = span_ratios(record);
  if (ratios.size() < 3) return;
  const double usual = statistics::median_of(ratios);
  std::vector<double> doubled;
  for (const double ratio : ratios) {
    if (ratio > kMost * usual) doubled.push_back(ratio / usual);
  }
  if (doubled.empty()) return;
  const double share = static_cast<double>(doubled.size()) / static_cast<double>(ratios.size());
  findings.push_back(
      {.name = "odometer_double_counting",
       .sentence = fmt::format("In {:.1f} % of the time above {:g} m/s the odometer counts {:.2g} "
                               "times as much as otherwise.",
                               100.0 * share, kDriving_m_s, statistics::median_of(doubled)),
       .figures = {{"share", single(share)}, {"times", single(statistics::median_of(doubled))}}});
}

void find_dead(const SpeedRecord& record, std::vector<OdometerFinding>& findings) {
  constexpr double kShortest_s = 2.0;
  double total_s = 0.0;
  double longest_s = 0.0;
  std::size_t count = 0;
  for (const Stretch& rows : stretches(record, [&](std::size_t row) {
         return record.is_silent(row) && is_driving(record, row);
       })) {
    const double length_s = record.time_s[rows.end - 1] - record.time_s[rows.begin];
    if (length_s < kShortest_s) continue;
    ++count;
    total_s += length_s;
    longest_s = std::max(longest_s, length_s);
  }
  if (count == 0) return;
  findings.push_back(
      {.name = "odometer_silent",
       .sentence = fmt::format("The odometer goes silent while the vehicle drives at more than "
                               "{:g} m/s: {} times, {:.0f} s in all.",
                               kDriving_m_s, count, total_s),
       .figures = {{"times", single(static_cast<double>(count))},
                   {"total_s", single(total_s)},
                   {"longest_s", single(longest_s)}}});
}

}  // namespace

std::vector<OdometerFinding> find_odometer_faults(const SpeedRecord& record,
                                                  const OdometerFigures& figures) {
  std::vector<OdometerFinding> findings;
  find_motion(record, findings);
  find_dead_band(record, figures, findings);
  find_latency(figures, findings);
  find_double_counting(record, findings);
  find_dead(record, findings);
  return findings;
}

const OdometerFinding* OdometerDiagnosis::find(std::string_view name) const {
  const auto found = std::ranges::find(findings, name, &OdometerFinding::name);
  return found == findings.end() ? nullptr : &*found;
}

std::string configuration_of(const SpeedRecord& record,
                             const std::vector<OdometerFinding>& findings) {
  constexpr std::array<std::string_view, 2> kKeys{"dead_band_mps", "latency_s"};
  std::string lines;
  for (const OdometerFinding& finding : findings) {
    for (const auto& [name, figure] : finding.figures) {
      if (std::ranges::find(kKeys, name) == kKeys.end()) continue;
      lines += fmt::format("{} = {:.2g}\n", name, figure.value);
    }
  }
  if (lines.empty()) return {};
  if (record.counts_pulses)
    lines += fmt::format("metres_per_pulse = {:.3g}\n", record.metres_per_pulse);
  return "[odometer]\n" + lines;
}

}  // namespace zerorate::odometry
