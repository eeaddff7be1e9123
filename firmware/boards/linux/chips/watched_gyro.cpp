#include "firmware/boards/linux/chips/watched_gyro.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace zerorate::linux_node {

std::uint32_t longest_repetition(double sigma, double lsb, double rate_hz) {
  constexpr double kOnceIn = 1e12;
  const double spread = 0.5 * sigma / lsb;
  const double left = std::erfc(0.5 / (std::numbers::sqrt2 * spread));  // P(the next count differs)
  const double most = std::log(kOnceIn) / -std::log1p(-left);
  if (!(most < drivers::Repetition::kEndless)) return drivers::Repetition::kEndless;
  return static_cast<std::uint32_t>(std::ceil(std::max(most, 0.5 * rate_hz)));
}

core::Result<std::size_t, drivers::DriverError> WatchedGyro::read(
    core::Instant now, std::span<drivers::GyroSample> out) {
  const auto count = gyro_->read(now, out);
  if (!count) return count;
  bool is_frozen = false;
  for (const drivers::GyroSample& sample : out.first(*count)) {
    is_frozen = repetition_.is_frozen_with(sample);
  }
  if (is_frozen) return drivers::refused(drivers::DriverErrorCode::frozen, 0);
  return count;
}

}  // namespace zerorate::linux_node
