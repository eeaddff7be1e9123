#include "host_tools/lib/identify/sensors_in_turn.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::identify {
namespace {

constexpr std::size_t kSamplesOfTurns = 240;  // a multiple of two, three and four

/// Largest difference between the mean second differences of the classes k mod `sensors`, and its
/// standard error. Second differences take slow motion off.
struct Difference {
  double size = 0.0;
  double error = 0.0;
};

Difference difference_of_turns(const RestSamples& samples, std::size_t axis, std::size_t first,
                               std::size_t sensors) {
  std::array<double, 4> sum{};
  std::array<double, 4> squares{};
  std::array<double, 4> count{};
  for (std::size_t k = first + 1; k + 1 < first + kSamplesOfTurns; ++k) {
    const auto rate = [&](std::size_t at) { return double{samples.rate_rad_s[at][axis]}; };
    const double bend = rate(k) - 0.5 * (rate(k - 1) + rate(k + 1));
    const std::size_t turn = k % sensors;
    sum[turn] += bend;
    squares[turn] += bend * bend;
    count[turn] += 1.0;
  }
  Difference difference;
  double least = sum[0] / count[0];
  double most = least;
  double variance = 0.0;
  for (std::size_t turn = 0; turn < sensors; ++turn) {
    const double mean = sum[turn] / count[turn];
    least = std::min(least, mean);
    most = std::max(most, mean);
    variance += squares[turn] / count[turn] - mean * mean;
  }
  difference.size = most - least;
  difference.error = std::sqrt(2.0 * variance / static_cast<double>(kSamplesOfTurns));
  return difference;
}

/// Changes of an axis over some samples; of one far beyond the usual the limit counts.
class Changes {
 public:
  Changes(const RestSamples& samples, std::size_t axis)
      : samples_(samples), axis_(axis), size_(std::min(samples.time.size(), kMost)) {
    constexpr double kFar = 8.0;  // medians
    limit_ = kFar * median(1);
  }

  /// How much more the samples 2 pair + 1 apart differ than those 2 pair + 2 apart [rad^2/s^2].
  [[nodiscard]] double contrast(std::size_t pair) const {
    return mean_square(2 * pair + 1) - mean_square(2 * pair + 2);
  }
  [[nodiscard]] double mean_square(std::size_t lag) const {
    double sum = 0.0;
    for (std::size_t k = lag; k < size_; ++k) {
      const double size = std::min(size_of(k, lag), limit_);
      sum += size * size;
    }
    return sum / static_cast<double>(size_ - lag);
  }
  [[nodiscard]] double size() const { return static_cast<double>(size_); }
  [[nodiscard]] double median(std::size_t lag) const {
    std::vector<double> sizes;
    for (std::size_t k = lag; k < size_; ++k) sizes.push_back(size_of(k, lag));
    return statistics::median_of(std::move(sizes));
  }

 private:
  static constexpr std::size_t kMost = 100'000;

  [[nodiscard]] double size_of(std::size_t k, std::size_t lag) const {
    return std::abs(double{samples_.rate_rad_s[k][axis_]} -
                    double{samples_.rate_rad_s[k - lag][axis_]});
  }

  const RestSamples& samples_;
  std::size_t axis_;
  std::size_t size_;
  double limit_ = 0.0;
};

/// Pairs of distances over which the contrasts of turns are looked at.
constexpr std::size_t kPairs = 32;

/// Distance of two levels that take turns, also where rows are lost [rad/s]: samples an odd number
/// apart then differ more than those an even number apart, the less the further apart they are. A
/// tone below half the sample rate reverses this over more samples, and differences of rounded
/// angles show it at the first lag only. nullopt where that is not so.
std::optional<double> distance_of_levels(const Changes& changes) {
  constexpr double kErrors = 6.0;
  constexpr double kShare =
      0.06;  // levels as far apart as their white noise, a third of the rows lost
  const double usual = changes.mean_square(2);
  const double error = 2.0 * usual / std::sqrt(changes.size());
  const double first = changes.contrast(0);
  if (!(first > std::max(kErrors * error, kShare * usual))) return std::nullopt;
  const double second = changes.contrast(1);
  if (second < std::max(0.5 * kErrors * error, 0.05 * first)) return std::nullopt;
  // Between two losses the turns hang together, so that contrasts scatter by a share of the first.
  const double tolerance = 0.25 * first + kErrors * error;
  for (std::size_t pair = 1; pair < kPairs; ++pair) {
    const double contrast = changes.contrast(pair);
    if (contrast < -tolerance || contrast > first + tolerance) return std::nullopt;
  }
  const double kept = std::min(1.0, std::sqrt(second / first));  // correlation of the turns
  return std::sqrt(2.0 * first / (kept + kept * kept));
}

/// Typical change from sample to sample where it is larger than that over two samples, and no tone
/// reverses this over more; nullopt otherwise [rad/s].
std::optional<double> change_of_turns(const Changes& changes) {
  constexpr double kLarger = 1.25;
  const double change = changes.median(1);
  if (!(change > kLarger * changes.median(2))) return std::nullopt;
  const double first = changes.contrast(0);
  if (changes.contrast(1) < 0.05 * first) return std::nullopt;
  const double reversal = -0.5 * std::abs(first);
  for (std::size_t pair = 1; pair < kPairs; ++pair) {
    if (changes.contrast(pair) < reversal) return std::nullopt;
  }
  return change;
}

/// How far two sensors are apart by all changes together; nullopt where no two take turns [rad/s].
std::optional<double> distance_by_changes(const RestSamples& samples, std::size_t axis) {
  const Changes changes{samples, axis};
  const std::optional<double> distance = distance_of_levels(changes);
  return distance ? distance : change_of_turns(changes);
}

}  // namespace

std::optional<std::string> sensors_in_turn(const RestSamples& samples) {
  constexpr double kErrors = 6.0;
  constexpr std::size_t kFewestBlocks = 4;
  constexpr std::size_t kMostJudged = 64;
  const std::size_t blocks = samples.time.size() / kSamplesOfTurns;
  if (blocks < kFewestBlocks) return std::nullopt;
  const std::size_t judged = std::min(blocks, kMostJudged);
  for (const std::size_t sensors : {2U, 3U, 4U}) {
    for (std::size_t axis = 0; axis < samples.axis_count; ++axis) {
      std::size_t different = 0;
      double sum_rad_s = 0.0;
      for (std::size_t i = 0; i < judged; ++i) {
        const std::size_t block = i * blocks / judged;
        const Difference found =
            difference_of_turns(samples, axis, block * kSamplesOfTurns, sensors);
        different += found.size > kErrors * found.error ? 1U : 0U;
        sum_rad_s += found.size;
      }
      double distance_rad_s = 0.5 * sum_rad_s / static_cast<double>(judged);
      if (2 * different <= judged) {
        const auto by_changes = sensors == 2 ? distance_by_changes(samples, axis) : std::nullopt;
        if (!by_changes) continue;
        distance_rad_s = *by_changes;
      }
      return fmt::format(
          "axis {}: every {} sample has a level of its own, {:.3g} deg/s from the others: {} "
          "sensors in one file{}? One of them is read by --where COLUMN=VALUE",
          samples.axis_name(axis),
          sensors == 2   ? "second"
          : sensors == 3 ? "third"
                         : "fourth",
          distance_rad_s * units::kDegPerRad, sensors,
          sensors == 2 ? ", or a tone near half the rate of the rows" : "");
    }
  }
  return std::nullopt;
}

}  // namespace zerorate::identify
