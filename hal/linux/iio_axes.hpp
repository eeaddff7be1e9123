/// @file
/// The axes of a sensor behind a driver of the kernel's Industrial I/O subsystem (IIO).
///
/// Source: Documentation/ABI/testing/sysfs-bus-iio of Linux 6.1.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/linux/sysfs.hpp"

namespace zerorate::hal::linux_os {

/// Quantity that a chip measures along its axes.
struct IioQuantity {
  std::string_view channel;    ///< part of the attributes' names
  std::string_view sensor;     ///< word for the sensor in messages
  std::string_view range_key;  ///< key of its range in a configuration, for messages
  bool may_have_one_axis;
};
inline constexpr IioQuantity kIioRate{"anglvel", "gyro", "full_scale_dps", true};  ///< in rad/s
inline constexpr IioQuantity kIioAcceleration{"accel", "accelerometer", "acceleration_range_g",
                                              false};  ///< in m/s2

/// The kernel prints so much of a scale, and cuts the rest.
inline constexpr double kIioDigits = 1e-9;

/// Whether a device measures the quantity along any axis.
[[nodiscard]] bool has_axes(const SysfsFolder& device, const IioQuantity& quantity);

/// Attribute of the quantity's sample rate; none: the driver has no rate, it is read when it is
/// asked.
[[nodiscard]] std::optional<std::string> rate_attribute(const SysfsFolder& device,
                                                        const IioQuantity& quantity = kIioRate);

/// The axes of one quantity of a device. Every function throws KernelFileError.
class IioAxes {
 public:
  using Raw = std::array<std::int64_t, 3>;  ///< before scale and mounting
  using Matrix = std::array<std::array<double, 3>, 3>;

  IioAxes(const SysfsFolder& device, const IioQuantity& quantity);
  /// Sets the smallest range that holds the full scale [SI]. A device without a choice of ranges
  /// must hold it.
  void set_range(double full_scale);

  /// Channels, as "in_anglvel_x". A chip with one axis gives it in all three places of a scan.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] double si_per_count() const { return scale_; }
  /// Counts at the end of the range.
  [[nodiscard]] std::int64_t counts() const { return counts_; }
  /// Attribute of the scale, once a range is set.
  [[nodiscard]] const std::string& scale_attribute() const { return scale_attribute_; }
  /// Rows of the matrix from the chip's axes to the vehicle's; the identity where the driver gives
  /// none.
  [[nodiscard]] const Matrix& mounting() const { return mounting_; }
  /// One value of each axis through its attribute, one after the other.
  [[nodiscard]] Raw read() const;

 private:
  [[nodiscard]] std::string attribute(std::string_view name) const;
  void find_counts();
  void read_mounting();

  SysfsFolder device_;
  IioQuantity quantity_;
  std::vector<std::string> names_;
  std::string scale_attribute_;
  double scale_ = 0.0;
  std::int64_t counts_ = 32768;
  Matrix mounting_{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
};

}  // namespace zerorate::hal::linux_os
