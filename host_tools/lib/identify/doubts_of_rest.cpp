#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host_tools/lib/identify/angles.hpp"
#include "host_tools/lib/identify/frozen_axes.hpp"
#include "host_tools/lib/identify/near_zero_mean.hpp"
#include "host_tools/lib/identify/repeated_blocks.hpp"
#include "host_tools/lib/identify/repeats.hpp"
#include "host_tools/lib/identify/rest_check.hpp"
#include "host_tools/lib/identify/sensors_in_turn.hpp"

namespace zerorate::identify {
namespace {

constexpr std::int64_t kShortestBurst = 8;

/// True if less than eight samples lie between two holes, in the mean: the holes are the rhythm of
/// the rows then, and no pauses.
bool has_holes_everywhere(const RestSamples& samples) {
  const core::Duration hole = std::max(core::Duration::nanoseconds(recording::kShortestHole),
                                       samples.mean_period * recording::kGapPeriods);
  std::size_t holes = 0;
  for (std::size_t k = 1; k < samples.time.size(); ++k)
    holes += samples.time[k] - samples.time[k - 1] > hole ? 1U : 0U;
  return holes * kShortestBurst > samples.time.size();
}

/// The median interval where the mean one is near it: pauses lengthen the mean, and bursts shorten
/// the median.
core::Duration typical_period(const RestSamples& samples) {
  if (has_holes_everywhere(samples)) {
    return (samples.time.back() - samples.time.front()) /
           static_cast<std::int64_t>(samples.time.size());
  }
  return samples.mean_period < samples.sample_period * kShortestBurst ? samples.sample_period
                                                                      : samples.mean_period;
}

std::vector<std::size_t> axes_besides(const std::vector<RestDoubt>& frozen,
                                      std::size_t axis_count) {
  std::vector<std::size_t> axes;
  for (std::size_t axis = 0; axis < axis_count; ++axis) {
    if (std::ranges::find(frozen, axis, &RestDoubt::axis) == frozen.end()) axes.push_back(axis);
  }
  return axes;
}

}  // namespace

std::vector<RestDoubt> doubts_of_rest(const RestSamples& all) {
  const RestSamples samples = without_repeats(all);
  RestCheck check{samples.axis_count, samples.sample_period, samples.mean_period,
                  samples.moving > 0};
  const std::vector<std::size_t> outliers = find_outliers(samples);
  for (std::size_t i = 0; i < samples.time.size(); ++i) {
    if (!std::ranges::binary_search(outliers, i)) check.add(samples.time[i], samples.rate_rad_s[i]);
  }
  std::vector<RestDoubt> doubts = check.doubts();
  const auto put_first = [&](std::string_view name, std::optional<std::string> sentence,
                             bool is_certain = true) {
    if (sentence) doubts.insert(doubts.begin(), {name, std::move(*sentence), is_certain});
  };
  std::string period = recording::doubt_of_period(typical_period(samples).ns());
  if (!samples.is_timed_by_rows && !period.empty()) put_first(doubt::kPeriod, std::move(period));
  put_first(doubt::kSensors, sensors_in_turn(samples));
  std::vector<RestDoubt> frozen = doubts_of_frozen_axes(all);
  put_first(doubt::kAngles, angles_not_rates(samples, axes_besides(frozen, samples.axis_count)));
  if (auto copies = doubt_of_repeated_blocks(samples)) {
    doubts.insert(doubts.begin(), std::move(*copies));
  }
  std::ranges::move(frozen, std::inserter(doubts, doubts.begin()));
  std::ranges::move(doubts_of_bias_taken_out(samples), std::back_inserter(doubts));
  return doubts;
}

std::vector<std::string> require_rest(const RestSamples& samples, const AcceptedDoubts& accepted,
                                      std::vector<std::size_t>& axes) {
  return require_rest(doubts_of_rest(samples), accepted, axes);
}

}  // namespace zerorate::identify
