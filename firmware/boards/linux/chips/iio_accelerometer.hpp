/// @file
/// The accelerometer beside a gyro that a driver of the kernel holds, read through IIO.
#pragma once

#include <array>
#include <optional>

#include "drivers/common/gyro_source.hpp"
#include "firmware/boards/linux/chips/gyro.hpp"
#include "hal/linux/iio_device.hpp"

namespace zerorate::linux_node {

/// Specific force along the axes of the vehicle.
using Force = std::array<core::Acceleration, 3>;

/// Force of a reading; none where an axis is at the end of the range or beyond.
/// @param range_m_s2 as the configuration has it
[[nodiscard]] std::optional<Force> force_of(const hal::linux_os::IioAxes& axes,
                                            const hal::linux_os::IioAxes::Raw& raw,
                                            double range_m_s2);

/// Range that the settings name [m/s2].
[[nodiscard]] double acceleration_range_m_s2(const GyroSettings& settings);

/// An accelerometer that is an IIO device of its own, whose readings go to the samples of a gyro.
/// With a buffer it is read at the gyro's rate. Without one its axes are read one after the other,
/// at most 25 times a second, in the gyro's thread.
class IioAccelerometer {
 public:
  /// Opens the device and sets range and rate. Throws KernelFileError.
  /// @param settings with a range and a device of the accelerometer
  IioAccelerometer(const GyroSettings& settings, const hal::linux_os::IioPlaces& places,
                   core::Instant now);

  /// Force for a sample of the gyro: the newest reading up to half a period after it, if that is
  /// not older than 100 ms. Each reading goes to one sample. Throws KernelFileError.
  [[nodiscard]] std::optional<Force> take(core::Instant sample, core::Instant now);
  /// False where another program changed a setting. Throws KernelFileError.
  [[nodiscard]] bool verify_next() { return device_.verify_next(); }
  [[nodiscard]] const hal::linux_os::IioIdentity& identity() const { return device_.identity(); }

 private:
  [[nodiscard]] std::optional<hal::linux_os::IioScan> next_scan();
  [[nodiscard]] std::optional<Force> take_from_buffer(core::Instant sample);
  [[nodiscard]] std::optional<Force> take_from_attributes(core::Instant now);
  void require_short_reading();

  std::string nodes_;
  double range_m_s2_;
  core::Duration period_;
  hal::linux_os::IioDevice device_;
  bool is_buffered_;
  core::Instant next_;                            ///< due time of a reading without a buffer
  std::optional<hal::linux_os::IioScan> ahead_;   ///< later than the newest sample of the gyro
  std::optional<hal::linux_os::IioScan> newest_;  ///< reading that no sample has taken
};

}  // namespace zerorate::linux_node
