#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "host_tools/lib/odometry/odometer_figures.hpp"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::odometry {
namespace {

constexpr double kLongest_s = 1.0;
constexpr double kStep_s = 0.05;
constexpr std::size_t kLags = 41;
constexpr double kMoving_m_s = 2.0;
constexpr double kBlock_s = 60.0;

double lag_s(std::size_t i) {
  return -kLongest_s + kStep_s * static_cast<double>(i);
}

/// Sums of the squared differences of a minute, for every lag.
struct Block {
  std::array<double, kLags> squares{};
  double rows = 0.0;
};

/// Reference at a time between its rows, or nothing within a gap.
std::optional<double> reference_at(const SpeedRecord& record, double time_s) {
  const auto after = std::ranges::lower_bound(record.time_s, time_s);
  if (after == record.time_s.begin() || after == record.time_s.end()) return std::nullopt;
  const auto row = static_cast<std::size_t>(after - record.time_s.begin());
  if (std::ranges::binary_search(record.gap_before, row)) return std::nullopt;
  const double share =
      (time_s - record.time_s[row - 1]) / (record.time_s[row] - record.time_s[row - 1]);
  return std::lerp(record.reference_m_s[row - 1], record.reference_m_s[row], share);
}

void add(Block& block, const SpeedRecord& record, std::size_t row) {
  std::array<double, kLags> squares{};
  for (std::size_t i = 0; i < kLags; ++i) {
    const auto reference = reference_at(record, record.time_s[row] - lag_s(i));
    if (!reference || *reference < kMoving_m_s) return;
    squares[i] = std::pow(record.odometer_m_s[row] - *reference, 2);
  }
  for (std::size_t i = 0; i < kLags; ++i) block.squares[i] += squares[i];
  block.rows += 1.0;
}

std::vector<Block> blocks_of(const SpeedRecord& record) {
  std::vector<Block> blocks;
  double begin_s = -std::numeric_limits<double>::infinity();
  for (std::size_t row = 0; row < record.size(); ++row) {
    if (record.odometer_m_s[row] < kMoving_m_s) continue;
    if (record.time_s[row] - begin_s >= kBlock_s) {
      begin_s = record.time_s[row];
      blocks.emplace_back();
    }
    add(blocks.back(), record, row);
  }
  std::erase_if(blocks, [](const Block& block) { return block.rows == 0.0; });
  return blocks;
}

/// Lag of the least sum, by a parabola through it and its neighbours; NaN at the ends.
double best_lag(const std::vector<Block>& blocks, const std::vector<std::size_t>& indices) {
  std::array<double, kLags> sum{};
  for (const std::size_t index : indices) {
    for (std::size_t i = 0; i < kLags; ++i) sum[i] += blocks[index].squares[i];
  }
  const auto best = static_cast<std::size_t>(std::ranges::min_element(sum) - sum.begin());
  if (best == 0 || best + 1 == kLags) return std::numeric_limits<double>::quiet_NaN();
  const double curvature = sum[best - 1] - 2.0 * sum[best] + sum[best + 1];
  const double slope = 0.5 * (sum[best + 1] - sum[best - 1]);
  return lag_s(best) - (curvature > 0.0 ? kStep_s * slope / curvature : 0.0);
}

}  // namespace

BootstrapFigure measure_latency(const SpeedRecord& record) {
  const std::vector<Block> blocks = blocks_of(record);
  if (blocks.empty()) return {};
  return statistics::bootstrap(blocks.size(),
                               [&](const auto& indices) { return best_lag(blocks, indices); },
                               random::RandomStream{1}.substream("latency"), {.draws = 1000});
}

}  // namespace zerorate::odometry
