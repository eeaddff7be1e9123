/// @file
/// A gyroscope or an accelerometer behind a driver of the kernel's Industrial I/O subsystem (IIO).
///
/// Source: Documentation/ABI/testing/sysfs-bus-iio of Linux 6.1.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/linux/file_storage.hpp"
#include "hal/linux/iio_axes.hpp"
#include "hal/linux/iio_element.hpp"
#include "hal/linux/sysfs.hpp"

namespace zerorate::hal::linux_os {

/// Places where the kernel shows its IIO devices.
struct IioPlaces {
  std::string sysfs = "/sys/bus/iio/devices";
  std::string nodes = "/dev";
  FileCalls* calls = nullptr;  ///< for the nodes; null: the real ones. Must outlive the device.
};

/// One row of a device.
struct IioScan {
  core::Instant time;
  IioAxes::Raw raw{};
  std::optional<IioAxes::Raw> acceleration;  ///< beside the rates of a gyro
  std::optional<std::int64_t> temperature;
};

/// An IIO device.
struct IioIdentity {
  std::string node;   ///< "iio:device0"
  std::string name;   ///< given by the driver; several devices can have the same
  std::string label;  ///< given by the device tree; often empty
};

/// Those that measure the quantity, by number.
[[nodiscard]] std::vector<IioIdentity> find_iio_devices(const IioPlaces& places,
                                                        const IioQuantity& quantity);
/// @param wanted  "iio:device0", "/dev/iio:device0", "0", a name or a label
/// Throws KernelFileError where there is none or more than one; its text lists those that are
/// there.
[[nodiscard]] IioIdentity find_iio_device(const IioPlaces& places, const IioQuantity& quantity,
                                          std::string_view wanted);

/// Values wanted of a device.
struct IioWishes {
  double rate_hz = 0.0;
  double full_scale = 0.0;  ///< range of the quantity [SI]
  /// Range of the accelerometer that a gyro's device has beside it, and that is read too.
  std::optional<double> acceleration_range_m_s2;
};

/// A device whose ranges and rate are set. Every function but the readers throws KernelFileError.
class IioDevice {
 public:
  /// @param quantity measured quantity
  IioDevice(const IioPlaces& places, const IioQuantity& quantity, std::string_view wanted,
            const IioWishes& wishes);

  [[nodiscard]] const IioIdentity& identity() const { return identity_; }
  [[nodiscard]] const IioAxes& axes() const { return axes_; }
  /// Axes of the accelerometer beside the gyro, where it is read too.
  [[nodiscard]] const std::optional<IioAxes>& acceleration() const { return acceleration_; }
  [[nodiscard]] double rate_hz() const { return rate_hz_; }
  [[nodiscard]] double celsius(std::int64_t raw) const;

  /// Whether the driver gives time stamped scans: it does where the chip's interrupt is wired.
  [[nodiscard]] bool has_buffer() const;
  /// Starts the buffer: time stamps of CLOCK_MONOTONIC, two seconds of room, a wake-up each 20 ms.
  void start_buffer();
  /// For poll(); -1 without a buffer.
  [[nodiscard]] int descriptor() const { return node_.get(); }
  /// Next scan of the buffer; none: nothing waits; an error number where the device cannot be read.
  [[nodiscard]] core::Result<std::optional<IioScan>, int> next_scan();

  /// One value of each axis through its attribute, one after the other. The time is not set.
  [[nodiscard]] IioScan read_attributes() const;
  /// The temperature's attribute, where there is one and it can be read now.
  [[nodiscard]] std::optional<std::int64_t> read_temperature() const;

  /// Settings that were written, in turn; false where one is no longer what it was.
  [[nodiscard]] bool verify_next();

 private:
  struct Setting {
    std::string attribute;
    std::string value;
  };

  void find_thermometer();
  void set_range(IioAxes& axes, double full_scale);
  /// @return the rate as the driver tells it; the wanted one where the driver has none
  double set_rate(const std::optional<std::string>& attribute, double rate_hz);
  void take_trigger() const;
  [[nodiscard]] std::vector<std::string> scanned_channels() const;
  void lay_out_scan();
  void keep(const std::string& attribute);
  void open_node();
  [[nodiscard]] bool refill(int& error);

  IioIdentity identity_;
  std::string nodes_;
  std::string devices_;
  FileCalls* calls_;
  SysfsFolder folder_;
  IioAxes axes_;
  std::optional<IioAxes> acceleration_;
  std::string temperature_;  ///< "in_temp" or "in_temp0"; empty: none
  double rate_hz_ = 0.0;
  double temperature_scale_ = 1.0;
  double temperature_offset_ = 0.0;
  std::vector<Setting> settings_;
  std::size_t verified_ = 0;

  Descriptor node_;
  std::vector<IioElement> elements_;  ///< elements of the axes, then of the accelerometer's
  std::optional<IioElement> temperature_element_;
  IioElement stamp_;
  std::size_t scan_bytes_ = 0;
  std::vector<std::uint8_t> bytes_;
  std::size_t begin_ = 0;  ///< first byte that is not yet decoded
  std::size_t end_ = 0;
};

}  // namespace zerorate::hal::linux_os
