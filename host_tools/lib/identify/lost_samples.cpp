#include "host_tools/lib/identify/lost_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::identify {
namespace {

/// Samples end to end.
struct BlockOfBursts {
  double duration_ns = 0.0;
  double samples = 0.0;
};

/// Blocks of some samples at least that end with a burst: the intervals within one were made by the
/// reader, and are equal but for rounding.
std::vector<BlockOfBursts> blocks_of_bursts(std::span<const core::Instant> times,
                                            std::size_t samples) {
  constexpr std::int64_t kOneOf = 10'000;
  std::vector<BlockOfBursts> blocks;
  std::size_t first = 0;
  std::int64_t before_ns = 0;
  for (std::size_t k = 1; k < times.size(); ++k) {
    const std::int64_t interval_ns = (times[k] - times[k - 1]).ns();
    const bool is_of_burst = std::abs(interval_ns - before_ns) <= before_ns / kOneOf;
    before_ns = interval_ns;
    if (is_of_burst || k - 1 - first < samples) continue;
    blocks.push_back({static_cast<double>((times[k - 1] - times[first]).ns()),
                      static_cast<double>(k - 1 - first)});
    first = k - 1;
  }
  return blocks;
}

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

/// Unevenness of blocks of whole bursts, with its relative standard error.
struct Unevenness {
  double share = 0.0;
  double error = 0.0;
  double interval_ns = 0.0;  ///< between samples; 0 where there are too few blocks
};

Unevenness unevenness_of_bursts(std::span<const core::Instant> times, std::size_t samples,
                                std::size_t fewest_blocks) {
  const std::vector<BlockOfBursts> blocks = blocks_of_bursts(times, samples);
  if (blocks.size() < fewest_blocks) return {};
  const auto of_blocks = [&](const auto& figure) {
    std::vector<double> figures(blocks.size());
    std::ranges::transform(blocks, figures.begin(), figure);
    return figures;
  };
  const double interval_ns = statistics::median_of(
      of_blocks([](const BlockOfBursts& block) { return block.duration_ns / block.samples; }));
  std::vector<double> deviations = of_blocks([&](const BlockOfBursts& block) {
    return (block.duration_ns - block.samples * interval_ns) / std::sqrt(block.samples);
  });
  return {.share = variance_about(0.0, std::move(deviations)) / (interval_ns * interval_ns),
          .error = std::sqrt(2.0 / static_cast<double>(blocks.size())),
          .interval_ns = interval_ns};
}

/// Jitter of the reader adds the less the longer the blocks, and more blocks have a smaller error:
/// 256 samples count, those of longer blocks where they show less by more than three errors, and 64
/// in a short recording.
LostShare lost_share_of_bursts(std::span<const core::Instant> times) {
  constexpr double kErrors = 3.0;
  constexpr std::size_t kFewestBlocks = 16;
  Unevenness found = unevenness_of_bursts(times, 256, kFewestBlocks);
  if (!(found.interval_ns > 0.0)) found = unevenness_of_bursts(times, 64, kFewestBlocks);
  if (!(found.interval_ns > 0.0)) return {};
  const Unevenness longer = unevenness_of_bursts(times, 1024, 2 * kFewestBlocks);
  const double most = longer.share * (1.0 + kErrors * std::hypot(longer.error, found.error));
  if (longer.interval_ns > 0.0 && most < found.share) found = longer;
  return {.by_unevenness = found.share,
          .most_by_unevenness = found.share,
          .mean_interval = core::Duration::nanoseconds(std::llround(found.interval_ns))};
}

}  // namespace

LostShare lost_share(std::span<const core::Instant> times, bool shares_stamps) {
  if (shares_stamps) return lost_share_of_bursts(times);
  constexpr std::size_t kFewestBlocks = 32;
  LostShare lost{.by_unevenness = 1.0, .most_by_unevenness = 1.0};
  double mean_ns = 0.0;
  for (const std::size_t samples : {64U, 256U, 1024U}) {
    if (times.size() <= kFewestBlocks * samples) break;
    std::vector<double> blocks = durations(times, samples);
    const std::size_t count = blocks.size();
    const double typical = statistics::median_of(blocks);
    const double variance_ns2 = variance_about(typical, std::move(blocks));
    const double share = static_cast<double>(samples) * variance_ns2 / (typical * typical);
    const double most = share * (1.0 + std::sqrt(2.0 / static_cast<double>(count)));
    lost.by_unevenness = std::min(lost.by_unevenness, share);
    lost.most_by_unevenness = std::min(lost.most_by_unevenness, most);
    mean_ns = typical / static_cast<double>(samples);
  }
  if (!(mean_ns > 0.0)) return {};
  lost.mean_interval = core::Duration::nanoseconds(std::llround(mean_ns));
  lost.by_intervals = std::max(0.0, 1.0 - shortest_common(durations(times, 1)) / mean_ns);
  return lost;
}

}  // namespace zerorate::identify
