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

/// Median change from every sample to the one `lag` behind it.
double median_change(const RestSamples& samples, std::size_t axis, std::size_t lag) {
  constexpr std::size_t kMost = 100'000;
  std::vector<double> changes;
  for (std::size_t k = lag; k < std::min(samples.time.size(), kMost); ++k) {
    changes.push_back(
        std::abs(double{samples.rate_rad_s[k][axis]} - double{samples.rate_rad_s[k - lag][axis]}));
  }
  return statistics::median_of(std::move(changes));
}

/// Whether neighbours differ more than every second sample: in turn, also where some are lost.
bool takes_turns(const RestSamples& samples, std::size_t axis) {
  constexpr double kLarger = 1.25;
  return median_change(samples, axis, 1) > kLarger * median_change(samples, axis, 2);
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
      const bool alternates = sensors == 2 && takes_turns(samples, axis);
      if (2 * different <= judged && !alternates) continue;
      return fmt::format(
          "axis {}: every {} sample has a level of its own, {:.3g} deg/s from the others: {} "
          "sensors in one file? One of them is read by --where COLUMN=VALUE",
          samples.axis_name(axis),
          sensors == 2   ? "second"
          : sensors == 3 ? "third"
                         : "fourth",
          0.5 * sum_rad_s / static_cast<double>(judged) * units::kDegPerRad, sensors);
    }
  }
  return std::nullopt;
}

}  // namespace zerorate::identify
