/// @file
/// Settings of a gyro that the kernel's driver reads.
#pragma once

#include <string>

#include "core/base/time.hpp"
#include "firmware/boards/linux/chips/gyro.hpp"

namespace zerorate::linux_node {

constexpr core::Instant kIioStart = core::Instant{} + core::Duration::seconds(100);

/// Gyro of the chip whose attributes made_iio.hpp has.
inline GyroSettings iio_settings(const std::string& device, double rate_hz = 104.0) {
  return {.chip = "lsm6dso",
          .bus = BusKind::iio,
          .device = device,
          .rate_hz = rate_hz,
          .full_scale_dps = 250.0};
}

}  // namespace zerorate::linux_node
