#include "host_tools/lib/identify/frozen_axes.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include "firmware/app/sample_watch.hpp"

namespace zerorate::identify {
namespace {

/// White variance of the quietest axis that shows any noise.
float least_variance(const RestSamples& samples) {
  double least = std::numeric_limits<double>::infinity();
  for (const double variance : variances_of_differences(samples)) {
    if (variance > 0.0) least = std::min(least, variance);
  }
  return std::isfinite(least) ? static_cast<float>(least) : 0.0F;
}

std::string sentence_on(const std::string& axis, std::size_t frozen, core::Duration until) {
  return fmt::format(
      "axis {} no longer measures: {} samples of it up to {:.6g} s repeat themselves as noise "
      "does not (a dead axis, one at full scale, a driver that hangs, a logger that fills gaps). "
      "Cut the recording to what was measured, or name the other axes: --axis",
      axis, frozen, static_cast<double>(until.ns()) * 1e-9);
}

}  // namespace

std::array<double, recording::kMaxAxes> variances_of_differences(const RestSamples& samples) {
  std::array<double, recording::kMaxAxes> variances{};
  for (std::size_t k = 1; k < samples.time.size(); ++k) {
    for (std::size_t i = 0; i < samples.axis_count; ++i) {
      const double change = samples.rate_rad_s[k][i] - samples.rate_rad_s[k - 1][i];
      variances[i] += 0.5 * change * change / static_cast<double>(samples.time.size());
    }
  }
  return variances;
}

std::vector<RestDoubt> doubts_of_frozen_axes(const RestSamples& samples) {
  app::SampleWatch<recording::kMaxAxes> watch{least_variance(samples), samples.sample_period};
  std::array<std::size_t, recording::kMaxAxes> frozen{};
  std::array<std::size_t, recording::kMaxAxes> newest{};
  for (std::size_t k = 0; k < samples.time.size(); ++k) {
    core::GyroSample sample{.time = samples.time[k]};
    for (std::size_t i = 0; i < samples.axis_count; ++i) {
      sample.rate[i] = core::rad_per_s(samples.rate_rad_s[k][i]);
    }
    const std::uint8_t at_fault = watch.take(sample, app::VehicleState::stands);
    for (std::size_t i = 0; i < samples.axis_count; ++i) {
      if (((at_fault >> i) & 1U) == 0) continue;
      ++frozen[i];
      newest[i] = k;
    }
  }
  std::vector<RestDoubt> doubts;
  for (std::size_t i = 0; i < samples.axis_count; ++i) {
    if (frozen[i] == 0) continue;
    const core::Duration until = samples.time[newest[i]] - samples.time.front();
    doubts.push_back({.name = doubt::kFrozen,
                      .sentence = sentence_on(samples.axis_name(i), frozen[i], until),
                      .axis = i});
  }
  return doubts;
}

}  // namespace zerorate::identify
