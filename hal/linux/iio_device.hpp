/// @file
/// A gyroscope behind a driver of the kernel's Industrial I/O subsystem (IIO).
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
#include "hal/linux/sysfs.hpp"

namespace zerorate::hal::linux_os {

/// Places where the kernel shows its IIO devices.
struct IioPlaces {
  std::string sysfs = "/sys/bus/iio/devices";
  std::string nodes = "/dev";
  FileCalls* calls = nullptr;  ///< for the nodes; null: the real ones. Must outlive the device.
};

/// Where a value stands in a scan, and how: "le:s16/16>>0".
struct IioElement {
  bool is_big_endian = false;
  bool is_signed = false;
  unsigned bits = 0;
  unsigned bytes = 0;  ///< size in the buffer: 1, 2, 4 or 8
  unsigned shift = 0;  ///< shift to the right before the bits are taken
  std::size_t offset = 0;

  [[nodiscard]] std::int64_t decode(std::span<const std::uint8_t> scan) const;
};
/// Throws KernelFileError, which names `path`. The offset is left at 0.
[[nodiscard]] IioElement parse_iio_type(std::string_view type, const std::string& path);

/// One row of the device's three axes.
struct IioScan {
  core::Instant time;
  std::array<std::int64_t, 3> raw{};  ///< before scale and mounting
  std::optional<std::int64_t> temperature;
};

/// An IIO device with a gyroscope.
struct IioIdentity {
  std::string node;   ///< "iio:device0"
  std::string name;   ///< given by the driver; several devices can have the same
  std::string label;  ///< given by the device tree; often empty
};

/// Those that have a channel of angular rate, by number.
[[nodiscard]] std::vector<IioIdentity> find_iio_gyros(const IioPlaces& places);
/// @param wanted  "iio:device0", "/dev/iio:device0", "0", a name or a label
/// Throws KernelFileError where there is none or more than one; its text lists those that are
/// there.
[[nodiscard]] IioIdentity find_iio_gyro(const IioPlaces& places, std::string_view wanted);

/// Attribute of a gyro's sample rate; none: the driver has no rate, it is read when it is asked.
[[nodiscard]] std::optional<std::string> rate_attribute(const SysfsFolder& device);

/// Values wanted of a device.
struct IioWishes {
  double rate_hz = 0.0;
  double full_scale_rad_s = 0.0;
};

/// A device whose scale and rate are set. Every function but the readers throws KernelFileError.
class IioDevice {
 public:
  /// Sets the smallest range that holds `wishes.full_scale_rad_s`, and the rate. A device without
  /// a choice of ranges must hold it.
  IioDevice(const IioPlaces& places, std::string_view wanted, const IioWishes& wishes);

  [[nodiscard]] const IioIdentity& identity() const { return identity_; }
  [[nodiscard]] double rad_s_per_count() const { return scale_; }
  [[nodiscard]] double rate_hz() const { return rate_hz_; }
  /// Rows of the matrix from the chip's axes to the vehicle's; the identity where the driver gives
  /// none.
  [[nodiscard]] const std::array<std::array<double, 3>, 3>& mounting() const { return mounting_; }
  /// Axes that the chip has. A chip with one gives it in all three places of a scan.
  [[nodiscard]] std::size_t axes() const { return axes_.size(); }
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

  void find_channels();
  void set_scale(double full_scale_rad_s);
  void set_rate(double rate_hz);
  void read_mounting();
  void take_trigger() const;
  void lay_out_scan();
  void keep(const std::string& attribute);
  void open_node();
  [[nodiscard]] bool refill(int& error);

  IioIdentity identity_;
  std::string nodes_;
  std::string devices_;
  FileCalls* calls_;
  SysfsFolder folder_;
  std::vector<std::string> axes_;  ///< "in_anglvel_x", ...
  std::string temperature_;        ///< "in_temp" or "in_temp0"; empty: none
  double scale_ = 0.0;
  double rate_hz_ = 0.0;
  double temperature_scale_ = 1.0;
  double temperature_offset_ = 0.0;
  std::array<std::array<double, 3>, 3> mounting_{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  std::vector<Setting> settings_;
  std::size_t verified_ = 0;

  Descriptor node_;
  std::vector<IioElement> elements_;  ///< elements of axes_
  std::optional<IioElement> temperature_element_;
  IioElement stamp_;
  std::size_t scan_bytes_ = 0;
  std::vector<std::uint8_t> bytes_;
  std::size_t begin_ = 0;  ///< first byte that is not yet decoded
  std::size_t end_ = 0;
};

}  // namespace zerorate::hal::linux_os
