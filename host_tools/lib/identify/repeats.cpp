#include "host_tools/lib/identify/repeats.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::identify {
namespace {

constexpr std::size_t kFarApart = 100;  // samples

/// Whether sample k equals the one `lag` before it on all axes.
bool repeats(const RestSamples& samples, std::size_t k, std::size_t lag) {
  const auto& now = samples.rate_rad_s[k];
  const auto& before = samples.rate_rad_s[k - lag];
  return std::equal(now.begin(), now.begin() + static_cast<std::ptrdiff_t>(samples.axis_count),
                    before.begin());
}

double share_of_repeats(const RestSamples& samples, std::size_t lag) {
  std::size_t equal = 0;
  for (std::size_t k = lag; k < samples.time.size(); ++k) equal += repeats(samples, k, lag);
  return static_cast<double>(equal) / static_cast<double>(samples.time.size() - lag);
}

/// Sizes of the changes between unequal neighbours.
std::vector<double> changes_of(const RestSamples& samples, std::size_t axis) {
  constexpr std::size_t kMost = 100'000;
  std::vector<double> changes;
  for (std::size_t k = 1; k < std::min(samples.time.size(), kMost); ++k) {
    const double change =
        std::abs(double{samples.rate_rad_s[k][axis]} - double{samples.rate_rad_s[k - 1][axis]});
    if (change > 0.0) changes.push_back(change);
  }
  return changes;
}

double smallest_of(const std::vector<double>& changes) {
  return changes.empty() ? 0.0 : *std::ranges::min_element(changes);
}

/// Median change between unequal neighbours, in steps of the smallest; 0 where nothing changes.
double change_in_steps(const RestSamples& samples, std::size_t axis) {
  std::vector<double> changes = changes_of(samples, axis);
  if (changes.empty()) return 0.0;
  const double step = smallest_of(changes);
  return statistics::median_of(std::move(changes)) / step;
}

bool may_repeat(const RestSamples& samples) {
  constexpr double kFewest = 0.05;
  constexpr double kBeyondChance = 5.0;
  constexpr double kFewestSteps = 4.0;
  if (samples.time.size() <= 2 * kFarApart) return false;
  const double share = share_of_repeats(samples, 1);
  if (share < kFewest || share < kBeyondChance * share_of_repeats(samples, kFarApart)) return false;
  for (std::size_t axis = 0; axis < samples.axis_count; ++axis) {
    if (change_in_steps(samples, axis) < kFewestSteps) return false;
  }
  return true;
}

/// Mean of the intervals that are no holes.
core::Duration mean_interval(const std::vector<core::Instant>& times) {
  std::int64_t sum_ns = 0;
  std::int64_t count = 0;
  for (std::size_t k = 1; k < times.size(); ++k) {
    const std::int64_t interval_ns = (times[k] - times[k - 1]).ns();
    if (interval_ns > recording::kShortestHole) continue;
    sum_ns += interval_ns;
    ++count;
  }
  return core::Duration::nanoseconds(count == 0 ? 0 : sum_ns / count);
}

}  // namespace

double smallest_step(const RestSamples& samples, std::size_t axis) {
  return smallest_of(changes_of(samples, axis));
}

std::vector<std::size_t> find_repeats(const RestSamples& samples) {
  std::vector<std::size_t> found;
  if (!may_repeat(samples)) return found;
  for (std::size_t k = 1; k < samples.time.size(); ++k) {
    if (repeats(samples, k, 1)) found.push_back(k);
  }
  return found;
}

RestSamples without_repeats(const RestSamples& samples) {
  const std::vector<std::size_t> found = find_repeats(samples);
  if (found.empty()) return samples;
  RestSamples rest = without(samples, found);
  rest.repeated += found.size();
  rest.mean_period = mean_interval(rest.time);
  rest.sample_period = rest.mean_period;
  find_lost_samples(rest);
  return rest;
}

}  // namespace zerorate::identify
