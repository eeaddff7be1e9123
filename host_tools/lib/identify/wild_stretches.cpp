#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "host_tools/lib/identify/rest_samples.hpp"
#include "host_tools/lib/statistics/sigma_of_changes.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::identify {
namespace {

/// Samples of half a second, from the first one on.
struct HalfSecond {
  std::size_t first = 0;
  std::size_t end = 0;

  [[nodiscard]] double size() const { return static_cast<double>(end - first); }
};

std::vector<HalfSecond> stretches_of(const RestSamples& samples) {
  constexpr std::int64_t kFewestSamples = 4;
  const core::Duration length =
      std::max(core::Duration::milliseconds(500), samples.mean_period * kFewestSamples);
  std::vector<HalfSecond> stretches;
  core::Instant end;
  for (std::size_t k = 0; k < samples.time.size(); ++k) {
    if (k == 0 || samples.time[k] >= end) {
      end = samples.time[k] + length;
      stretches.push_back({.first = k, .end = k});
    }
    stretches.back().end = k + 1;
  }
  return stretches;
}

std::vector<double> means_of(const std::vector<HalfSecond>& stretches, const RestSamples& samples,
                             std::size_t axis) {
  std::vector<double> means;
  for (const HalfSecond& one : stretches) {
    double sum = 0.0;
    for (std::size_t k = one.first; k < one.end; ++k) sum += double{samples.rate_rad_s[k][axis]};
    means.push_back(sum / one.size());
  }
  return means;
}

double median_around(const std::vector<double>& means, std::size_t k) {
  constexpr std::size_t kReach = 8;
  const std::size_t first = std::min(k > kReach ? k - kReach : 0, means.size() - 2 * kReach - 1);
  std::vector<double> around;
  for (std::size_t i = first; i <= first + 2 * kReach; ++i) {
    if (i != k) around.push_back(means[i]);
  }
  return statistics::median_of(std::move(around));
}

}  // namespace

std::vector<std::size_t> find_wild_stretches(const RestSamples& samples) {
  constexpr std::size_t kFewest = 64;
  constexpr double kSigmas = 10.0;
  constexpr double kMost = 0.05;
  const std::vector<HalfSecond> stretches = stretches_of(samples);
  if (stretches.size() < kFewest) return {};
  const double usual_size =
      static_cast<double>(samples.time.size()) / static_cast<double>(stretches.size());
  std::vector<bool> is_wild(stretches.size(), false);
  for (std::size_t axis = 0; axis < samples.axis_count; ++axis) {
    const std::vector<double> means = means_of(stretches, samples, axis);
    const double limit = kSigmas * statistics::sigma_of_changes(means);
    if (!(limit > 0.0)) continue;
    for (std::size_t k = 0; k < means.size(); ++k) {
      const double shortness = std::sqrt(std::max(1.0, usual_size / stretches[k].size()));
      if (std::abs(means[k] - median_around(means, k)) > limit * shortness) is_wild[k] = true;
    }
  }
  const auto wild = static_cast<double>(std::ranges::count(is_wild, true));
  if (wild > kMost * static_cast<double>(stretches.size())) return {};
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    for (std::size_t k = stretches[i].first; is_wild[i] && k < stretches[i].end; ++k) {
      found.push_back(k);
    }
  }
  return found;
}

}  // namespace zerorate::identify
