#include "firmware/boards/linux/chips/iio_accelerometer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>

#include "hal/linux/clock.hpp"

namespace zerorate::linux_node {
namespace {

using hal::linux_os::IioScan;
using hal::linux_os::KernelFileError;

constexpr core::Duration kOldest = core::Duration::milliseconds(100);
/// Period of an accelerometer without a buffer: a tick of half a second then has a dozen readings.
constexpr core::Duration kPolledPeriod = core::Duration::milliseconds(40);
/// The gyro waits for each reading of an accelerometer without a buffer.
constexpr core::Duration kLongestReading = core::Duration::milliseconds(5);

}  // namespace

std::optional<Force> force_of(const hal::linux_os::IioAxes& axes,
                              const hal::linux_os::IioAxes::Raw& raw, double range_m_s2) {
  std::array<double, 3> measured{};
  for (std::size_t axis = 0; axis < raw.size(); ++axis) {
    measured.at(axis) = static_cast<double>(raw.at(axis)) * axes.si_per_count();
    const bool is_at_end = std::abs(raw.at(axis)) >= axes.counts() - 1;
    if (is_at_end || std::abs(measured.at(axis)) >= range_m_s2) return std::nullopt;
  }
  Force force{};
  for (std::size_t row = 0; row < force.size(); ++row) {
    double sum = 0.0;
    for (std::size_t axis = 0; axis < raw.size(); ++axis) {
      sum += axes.mounting().at(row).at(axis) * measured.at(axis);
    }
    force.at(row) = core::m_per_s2(static_cast<float>(sum));
  }
  return force;
}

double acceleration_range_m_s2(const GyroSettings& settings) {
  return *settings.acceleration_range_g * double{core::kStandardGravity_m_s2};
}

IioAccelerometer::IioAccelerometer(const GyroSettings& settings,
                                   const hal::linux_os::IioPlaces& places, core::Instant now)
    : nodes_(places.nodes),
      range_m_s2_(acceleration_range_m_s2(settings)),
      period_(core::Duration::nanoseconds(std::llround(1e9 / settings.rate_hz))),
      device_(places, hal::linux_os::kIioAcceleration, settings.accelerometer_device,
              {.rate_hz = settings.rate_hz, .full_scale = range_m_s2_}),
      is_buffered_(device_.has_buffer()),
      next_(now) {
  if (is_buffered_) {
    device_.start_buffer();
  } else {
    require_short_reading();
  }
}

void IioAccelerometer::require_short_reading() {
  const core::Instant before = hal::linux_os::KernelClock::now();
  (void)device_.read_attributes();
  const core::Duration taken = hal::linux_os::KernelClock::now() - before;
  if (taken <= kLongestReading) return;
  throw KernelFileError(
      device_.identity().node,
      "no buffer, and reading all axes takes " + std::to_string(taken.ns() / 1'000'000) + " ms",
      "wire the accelerometer's interrupt line, or leave acceleration out");
}

std::optional<Force> IioAccelerometer::take(core::Instant sample, core::Instant now) {
  return is_buffered_ ? take_from_buffer(sample) : take_from_attributes(now);
}

std::optional<IioScan> IioAccelerometer::next_scan() {
  if (ahead_) return std::exchange(ahead_, std::nullopt);
  auto next = device_.next_scan();
  if (!next) {
    throw KernelFileError(nodes_ + "/" + device_.identity().node, next.error(),
                          "was the device unplugged?");
  }
  return *next;
}

std::optional<Force> IioAccelerometer::take_from_buffer(core::Instant sample) {
  while (const auto scan = next_scan()) {
    if (scan->time > sample + period_ / 2) {
      ahead_ = scan;
      break;
    }
    newest_ = scan;
  }
  const auto taken = std::exchange(newest_, std::nullopt);
  if (!taken || sample - taken->time > kOldest) return std::nullopt;
  return force_of(device_.axes(), taken->raw, range_m_s2_);
}

std::optional<Force> IioAccelerometer::take_from_attributes(core::Instant now) {
  if (now < next_) return std::nullopt;
  next_ = now + std::max(period_, kPolledPeriod);
  return force_of(device_.axes(), device_.read_attributes().raw, range_m_s2_);
}

}  // namespace zerorate::linux_node
