/// @file
/// Interface of a gyro driver to the application, whatever the chip and the bus.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "core/samples/gyro_sample.hpp"
#include "drivers/common/driver_error.hpp"

namespace zerorate::drivers {

using core::GyroSample;

/// A gyro that is polled. Never sleeps, retries or logs: the application owns time and counts.
///
/// - `start(now)`: identity, reset, configuration, read-back. Where the chip needs time it returns
///   not_ready: call it again, with a later now, until it succeeds. Call it after
///   configuration_lost too. Samples that the datasheet asks to discard after power-up never leave
///   read().
/// - `read(now, out)`: the samples available now, oldest first, 0 if none yet. In data-ready mode a
///   sample is stamped now (pass the stamp of the data-ready edge where there is one). From a FIFO,
///   samples are stamped one sample period apart, the newest in the chip no later than now and less
///   than one period before it (sample_clock.hpp). What does not fit into out stays in the FIFO: an
///   out that comes back full means that there may be more. An error loses the samples of that
///   call. A driver that reads the accelerometer (acceleration.hpp) gives samples the acceleration
///   of the same time; one whose acceleration is saturated or was lost comes without it.
/// - `verify_next()`: re-reads one configuration register; call it once a tick.
///   configuration_lost: the chip was reset or upset; start again.
/// - `sample_period()`: the chip's own period, trimmed where the chip has a trim register.
/// - `lsb()`: the rate of one count, known after a start; zero where it is not known.
/// - `is_batched()`: true if samples wait in a FIFO. The `now` of read() must then be the time of
///   the reading: the edge of a watermark is older than the samples that came after it.
template <class Source>
concept GyroSource = requires(Source& source, const Source& same, core::Instant now,
                              std::span<GyroSample> out) {
  { source.start(now) } -> std::same_as<core::Result<void, DriverError>>;
  { source.read(now, out) } -> std::same_as<core::Result<std::size_t, DriverError>>;
  { source.verify_next() } -> std::same_as<core::Result<void, DriverError>>;
  { same.sample_period() } -> std::same_as<core::Duration>;
  { same.lsb() } -> std::same_as<core::AngularRate>;
  { same.is_batched() } -> std::same_as<bool>;
};

/// Sets the rates and the saturated axes of a sample. One multiplication an axis, so that raw 0 is
/// exactly 0.
/// @param lsb the rate of one count
/// @param highest_raw, lowest_raw  an axis is saturated at these counts or beyond
constexpr void set_rates(GyroSample& sample, const std::array<std::int16_t, 3>& raw,
                         core::AngularRate lsb, std::int16_t highest_raw, std::int16_t lowest_raw) {
  sample.saturated_axes = 0;
  for (std::size_t axis = 0; axis < raw.size(); ++axis) {
    sample.rate[axis] = lsb * static_cast<float>(raw[axis]);
    if (raw[axis] >= highest_raw || raw[axis] <= lowest_raw) {
      sample.saturated_axes |= static_cast<std::uint8_t>(1U << axis);
    }
  }
}
/// Rates and saturated axes for a range of plus or minus so many counts.
constexpr void set_rates(GyroSample& sample, const std::array<std::int16_t, 3>& raw,
                         core::AngularRate lsb, std::int16_t full_scale_raw) {
  set_rates(sample, raw, lsb, full_scale_raw, static_cast<std::int16_t>(-full_scale_raw));
}

/// Two's complement from its low and its high byte, in whatever order the chip sends them.
[[nodiscard]] constexpr std::int16_t decode_int16(std::uint8_t low, std::uint8_t high) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(low | (high << 8U)));
}

}  // namespace zerorate::drivers
