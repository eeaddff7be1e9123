#include "host_tools/lib/contest/standings.hpp"

#include <cmath>
#include <limits>
#include <numeric>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::contest {
namespace {

using Drawn = std::vector<std::size_t>;

Drawn every_cluster(const DriveResults& results) {
  Drawn all(results.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

/// Geometric mean over the clusters drawn (as often as they are named) and a range of schedules.
double ratio_over(const DriveResults& own, const DriveResults& other, const Drawn& drawn,
                  ScheduleRange range) {
  double log_ratio = 0.0;
  double count = 0.0;
  for (const std::size_t c : drawn) {
    for (std::size_t s = range.first; s < range.last; ++s) {
      const DriveSums& a = own[c][s];
      const DriveSums& b = other[c][s];
      if (b.drives == 0.0) continue;
      log_ratio += 0.5 * std::log(a.squares_rad2 / a.drives / (b.squares_rad2 / b.drives));
      ++count;
    }
  }
  return std::exp(log_ratio / count);
}

DriveSums total(const DriveResults& own, const Drawn& drawn, ScheduleRange range) {
  DriveSums sums;
  for (const std::size_t c : drawn) {
    for (std::size_t s = range.first; s < range.last; ++s) sums += own[c][s];
  }
  return sums;
}

}  // namespace

DriveSums sums_of(const evaluate::DriveScores& scores) {
  if (scores.drives() == 0) return {};
  const auto n = static_cast<double>(scores.drives());
  const double rms_rad = scores.heading_drift_rms_rad();
  return {.drives = n,
          .squares_rad2 = n * rms_rad * rms_rad,
          .covered = n * scores.coverage95(),
          .sigma_rad = n * scores.sigma_over_rms() * rms_rad};
}

DriveStanding Standings::standing(const DriveResults& own, ScheduleRange range) const {
  const DriveSums sums = total(own, every_cluster(own), range);
  const double rms_rad = std::sqrt(sums.squares_rad2 / sums.drives);
  const bool has_interval = !std::isnan(sums.covered);
  return {.ratio = ratio(own, yardstick_, range),
          .coverage = over_clusters([&](const auto& drawn) {
            const DriveSums some = total(own, drawn, range);
            return some.covered / some.drives;
          }),
          .sigma_over_rms = has_interval ? sums.sigma_rad / sums.drives / rms_rad
                                         : std::numeric_limits<double>::quiet_NaN(),
          .drift_rms_deg = rms_rad * units::kDegPerRad};
}

BootstrapFigure Standings::ratio(const DriveResults& own, const DriveResults& other,
                                 ScheduleRange range) const {
  return over_clusters([&](const auto& drawn) { return ratio_over(own, other, drawn, range); });
}

double Standings::drives(ScheduleRange range) const {
  return total(yardstick_, every_cluster(yardstick_), range).drives;
}

BootstrapFigure Standings::over_clusters(const statistics::Statistic& statistic) const {
  return statistics::bootstrap(yardstick_.size(), statistic, random::RandomStream{seed_});
}

}  // namespace zerorate::contest
