#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "host_tools/lib/identify/rest_samples.hpp"
#include "host_tools/lib/statistics/sigma_of_changes.hpp"

namespace zerorate::identify {
namespace {

/// Outliers of one axis: runs that a jump begins and a jump back ends.
class OutlierSearch {
 public:
  OutlierSearch(const RestSamples& samples, std::size_t axis) : samples_(samples), axis_(axis) {}

  /// Whether a block has a change that is large beside the others.
  [[nodiscard]] bool may_have_outliers(std::size_t first, std::size_t end) const {
    constexpr double kLarge = 15.0;  // 20 standard deviations are 18 mean changes
    double sum = 0.0;
    double most = 0.0;
    for (std::size_t k = std::max<std::size_t>(first, 1); k < end; ++k) {
      sum += change(k);
      most = std::max(most, change(k));
    }
    return most * static_cast<double>(end - first) > kLarge * sum;
  }

  void search(std::size_t first, std::size_t end, std::vector<std::size_t>& found) const {
    const double limit = limit_in(first, end);
    for (std::size_t k = std::max<std::size_t>(first, 1); k < end; ++k) {
      if (!(change(k) > limit)) continue;
      const std::size_t run = run_at(k);
      for (std::size_t i = 0; i < run; ++i) found.push_back(k + i);
      k += run;
    }
  }

 private:
  [[nodiscard]] double rate(std::size_t k) const { return double{samples_.rate_rad_s[k][axis_]}; }
  [[nodiscard]] double change(std::size_t k) const { return std::abs(rate(k) - rate(k - 1)); }

  /// Samples from k on that lie apart from those before and behind them; 0 where none do.
  [[nodiscard]] std::size_t run_at(std::size_t k) const {
    constexpr std::size_t kLongest = 5;
    constexpr std::size_t kAround = 32;
    const std::size_t size = samples_.time.size();
    const double limit = limit_in(k > kAround ? k - kAround : 0, std::min(size, k + kAround));
    if (!(change(k) > limit)) return 0;
    for (std::size_t run = 1; run <= kLongest && k + run < size; ++run) {
      if (change(k + run) > limit && std::abs(rate(k + run) - rate(k - 1)) < 0.5 * limit)
        return is_alone(k, run) ? run : 0;
    }
    return 0;
  }

  /// Whether the samples next to a run are as calm as those farther away. Samples beside the swing
  /// of a vehicle that rocks are not calm, and such a swing is no outlier.
  [[nodiscard]] bool is_alone(std::size_t k, std::size_t run) const {
    constexpr std::size_t kNear = 6;
    std::vector<double> near;
    for (std::size_t i = k > kNear ? k - kNear : 1; i < k; ++i) near.push_back(change(i));
    const std::size_t end = std::min(samples_.time.size(), k + run + 1 + kNear);
    for (std::size_t i = k + run + 1; i < end; ++i) near.push_back(change(i));
    const double jump = std::min(change(k), change(k + run));
    return near.empty() || jump > kSigmas * statistics::sigma_by_median(std::move(near));
  }

  /// Twenty standard deviations of the white noise of some samples by their changes. Equal
  /// neighbours, which coarse steps and loggers that repeat a sample make, are no change.
  [[nodiscard]] double limit_in(std::size_t first, std::size_t end) const {
    return kSigmas * sigma_of(first + 1, end);
  }

  /// Infinite where nothing changes.
  [[nodiscard]] double sigma_of(std::size_t first, std::size_t end) const {
    std::vector<double> changes;
    for (std::size_t k = first; k < end; ++k) {
      if (change(k) > 0.0) changes.push_back(change(k));
    }
    if (changes.empty()) return std::numeric_limits<double>::infinity();
    return statistics::sigma_by_median(std::move(changes));
  }

  static constexpr double kSigmas = 20.0;

  const RestSamples& samples_;
  std::size_t axis_;
};

}  // namespace

std::vector<std::size_t> find_outliers(const RestSamples& samples) {
  constexpr std::size_t kBlock = 4096;
  constexpr std::size_t kFewest = 64;
  std::vector<std::size_t> found;
  const std::size_t size = samples.time.size();
  if (size < kFewest) return found;
  for (std::size_t axis = 0; axis < samples.axis_count; ++axis) {
    const OutlierSearch outliers{samples, axis};
    for (std::size_t first = 0; first < size; first += kBlock) {
      const std::size_t end = std::min(size, first + kBlock);
      // A short rest is judged with samples of the block before it.
      const std::size_t begin = end - first < kFewest ? end - kFewest : first;
      if (outliers.may_have_outliers(begin, end)) outliers.search(begin, end, found);
    }
  }
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace zerorate::identify
