/// @file
/// The gyros that this board can be wired to, chosen by name at run time.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "drivers/common/any_gyro.hpp"
#include "drivers/common/driver_error.hpp"

namespace zerorate::linux_node {

/// `udp` and `unix_socket`: another program sends the samples.
enum class BusKind : std::uint8_t { spi, i2c, iio, udp, unix_socket };

/// Name of the gyro that needs no hardware: an LSM6DSO at the level of its registers.
inline constexpr std::string_view kSimulatedChip = "simulated";

/// How one gyro is wired and set.
struct GyroSettings {
  std::string chip;  ///< a ChipDescription's name, or kSimulatedChip; on IIO also empty: unknown
  BusKind bus = BusKind::spi;  ///< one of the chip's
  std::string device;  ///< "/dev/spidev0.0", "/dev/i2c-1"; on IIO see find_iio_device; by message
                       ///< the origin's name
  std::uint8_t address = 0;            ///< on I2C
  std::uint32_t speed_hz = 1'000'000;  ///< on SPI
  double rate_hz = 0.0;                ///< one of the chip's
  double full_scale_dps = 0.0;         ///< one of the chip's
  bool fifo = false;                   ///< samples through the chip's FIFO
  std::string config_file;  ///< path of the file that the chip needs at each start; empty: none
  /// Range of the accelerometer, one of the chip's; none: samples carry no acceleration.
  std::optional<double> acceleration_range_g;
  std::uint8_t accelerometer_address = 0;  ///< on I2C, of a chip whose accelerometer answers apart
  std::string accelerometer_device;        ///< its node on SPI; on IIO as `device`
  double time_factor = 1.0;  ///< speed of the simulated gyro's clock over the true one
  bool drives = true;        ///< whether the simulated vehicle ever leaves its place

  [[nodiscard]] bool is_by_message() const {
    return bus == BusKind::udp || bus == BusKind::unix_socket;
  }
  [[nodiscard]] bool is_simulated() const { return chip == kSimulatedChip; }
  /// Name of the chip whose rates, ranges and noise model are the gyro's.
  [[nodiscard]] std::string_view model_chip() const {
    return is_simulated() ? std::string_view{"lsm6dso"} : std::string_view{chip};
  }
};

/// Reasons behind a driver's error that the driver does not know.
struct GyroReason {
  int error_number = 0;                   ///< errno of the kernel; 0: none
  std::optional<std::uint32_t> identity;  ///< answer of a chip that is not the expected one
  std::string told;                       ///< place, reason and cure in words; empty: not known
};

/// A gyro behind a node of /dev.
class DeviceGyro : public drivers::AnyGyro {
 public:
  /// Reason of the newest error. Where that is a wrong identity, the chip is asked once more.
  [[nodiscard]] virtual GyroReason reason(drivers::DriverErrorCode code) = 0;
  /// For poll(): readable when samples wait. -1: there is no such descriptor.
  [[nodiscard]] virtual int descriptor() const { return -1; }
};

/// Values that a configuration may choose for a chip, and the function that makes the chip's gyro.
struct ChipDescription {
  std::string_view name;
  std::span<const double> rates_hz;               ///< values of the data sheet
  std::span<const double> full_scales_dps;        ///< values of the data sheet
  std::span<const double> acceleration_ranges_g;  ///< none: no accelerometer that is read
  double usual_acceleration_range_g;              ///< one of them
  /// On I2C, of an accelerometer that answers apart; none: it is read through the gyro's bus.
  std::span<const std::uint8_t> accelerometer_addresses;
  std::span<const std::uint8_t> addresses;  ///< on I2C; none: not on I2C
  std::uint32_t highest_speed_hz;           ///< on SPI
  bool has_fifo;
  bool has_thermometer;
  bool needs_config_file;                ///< a file of its maker's, at each start
  double counts;                         ///< at full scale; one is the LSB
  std::optional<std::uint8_t> identity;  ///< answer of a chip with registers
  /// Throws hal::linux_os::KernelFileError where the config file cannot be read or cannot be one.
  /// @param settings must be possible by this description
  std::unique_ptr<DeviceGyro> (*make)(const GyroSettings& settings);
};

/// All of them, by name.
[[nodiscard]] std::span<const ChipDescription> chips();
/// nullptr where there is none of that name.
[[nodiscard]] const ChipDescription* find_chip(std::string_view name);

/// The gyro that the settings name, which must be possible. Throws std::runtime_error where a
/// driver of the kernel holds the chip: two programs cannot share it.
/// @param sysfs  where the kernel shows its devices
[[nodiscard]] std::unique_ptr<DeviceGyro> make_gyro(const GyroSettings& settings,
                                                    const std::string& sysfs = "/sys");

}  // namespace zerorate::linux_node
