#include "host_tools/lib/identify/lost_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::identify {
namespace {

/// Durations of blocks of some samples, end to end [ns].
std::vector<double> durations(std::span<const core::Instant> times, std::size_t samples) {
  std::vector<double> found;
  for (std::size_t k = samples; k < times.size(); k += samples)
    found.push_back(static_cast<double>((times[k] - times[k - samples]).ns()));
  return found;
}

/// Mean of the intervals near the one that four of five exceed [ns].
double shortest_common(std::vector<double> intervals) {
  const auto fifth = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 5);
  std::ranges::nth_element(intervals, fifth);
  const double typical = *fifth;
  double sum = 0.0;
  double count = 0.0;
  for (const double interval : intervals) {
    if (interval < 0.75 * typical || interval > 1.5 * typical) continue;
    sum += interval;
    count += 1.0;
  }
  return count > 0.0 ? sum / count : typical;
}

/// Variance about the median of blocks that lie within four standard deviations [ns^2]. The median
/// deviation alone is a whole number of periods, too coarse where few samples are lost.
double variance_about(double typical, std::vector<double> blocks) {
  constexpr double kDeviationPerSigma = 0.6744897501960817;
  for (double& block : blocks) block = std::abs(block - typical);
  const double limit = 4.0 / kDeviationPerSigma * statistics::median_of(blocks);
  double sum = 0.0;
  double count = 0.0;
  for (const double deviation : blocks) {
    if (deviation > limit) continue;
    sum += deviation * deviation;
    count += 1.0;
  }
  return sum / count;
}

}  // namespace

LostShare lost_share(std::span<const core::Instant> times, bool shares_stamps) {
  const std::size_t fewest_blocks = shares_stamps ? 16 : 32;
  LostShare lost{.by_unevenness = 1.0, .most_by_unevenness = 1.0};
  double mean_ns = 0.0;
  for (const std::size_t samples : {64U, 256U, 1024U}) {
    if (times.size() <= fewest_blocks * samples) break;
    std::vector<double> blocks = durations(times, samples);
    const std::size_t count = blocks.size();
    const double typical = statistics::median_of(blocks);
    const double variance_ns2 = variance_about(typical, std::move(blocks));
    const double share = static_cast<double>(samples) * variance_ns2 / (typical * typical);
    const double most = share * (1.0 + std::sqrt(2.0 / static_cast<double>(count)));
    lost.by_unevenness = shares_stamps ? share : std::min(lost.by_unevenness, share);
    lost.most_by_unevenness = shares_stamps ? share : std::min(lost.most_by_unevenness, most);
    mean_ns = typical / static_cast<double>(samples);
  }
  if (!(mean_ns > 0.0)) return {};
  lost.mean_interval = core::Duration::nanoseconds(std::llround(mean_ns));
  if (shares_stamps) return lost;
  lost.by_intervals = std::max(0.0, 1.0 - shortest_common(durations(times, 1)) / mean_ns);
  return lost;
}

}  // namespace zerorate::identify
