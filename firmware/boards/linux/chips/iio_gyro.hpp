/// @file
/// A gyro that a driver of the kernel holds, read through IIO.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "firmware/boards/linux/chips/gyro.hpp"
#include "firmware/boards/linux/chips/iio_accelerometer.hpp"
#include "hal/linux/iio_device.hpp"

namespace zerorate::linux_node {

/// Highest rate at which a device without a buffer is read, attribute by attribute.
inline constexpr double kHighestPolledRate_hz = 100.0;

/// Chip whose name a device's name begins with ("lsm6dso_gyro"); empty: none is known.
[[nodiscard]] std::string_view chip_of_iio(std::string_view device);

/// A GyroSource over an IioDevice. The scale is the chip's own where `settings.chip` is known and
/// the driver's is the same to 1 %. Each failure of the kernel is kept in words. A device that was
/// unplugged is looked for again at the next start(). A temperature is passed on unless the chip
/// has no thermometer. The acceleration comes from the device that the settings name: the gyro's
/// own, or another one.
///
/// With a buffer the samples carry the kernel's stamps of the chip's interrupt, and a gap between
/// two of them is fifo_overrun. Without one the axes are read one after the other, once a period,
/// and the sample is stamped when it is read.
class IioGyro final : public DeviceGyro {
 public:
  explicit IioGyro(const GyroSettings& settings, hal::linux_os::IioPlaces places = {});

  core::Result<void, drivers::DriverError> start(core::Instant now) override;
  core::Result<std::size_t, drivers::DriverError> read(core::Instant now,
                                                       std::span<drivers::GyroSample> out) override;
  core::Result<void, drivers::DriverError> verify_next() override;
  [[nodiscard]] core::Duration sample_period() const override { return period_; }
  [[nodiscard]] core::AngularRate lsb() const override {
    return core::rad_per_s(static_cast<float>(rad_s_per_count_));
  }
  [[nodiscard]] bool is_batched() const override { return is_buffered_; }
  GyroReason reason(drivers::DriverErrorCode code) override;
  [[nodiscard]] int descriptor() const override { return device_ ? device_->descriptor() : -1; }

 private:
  using Count = core::Result<std::size_t, drivers::DriverError>;

  void open(core::Instant now);
  Count read_buffer(core::Instant now, std::span<drivers::GyroSample> out);
  Count read_attributes(core::Instant now, std::span<drivers::GyroSample> out);
  [[nodiscard]] bool is_after_gap(core::Instant time) const;
  [[nodiscard]] bool has_own_accelerometer() const;
  [[nodiscard]] drivers::GyroSample sample_of(const hal::linux_os::IioScan& scan,
                                              core::Instant now);
  [[nodiscard]] std::optional<Force> force_at(const hal::linux_os::IioScan& scan,
                                              core::Instant now);
  core::Unexpected<drivers::DriverError> failed(const hal::linux_os::KernelFileError& error);
  core::Unexpected<drivers::DriverError> failed(hal::BusError bus, std::string told);

  GyroSettings settings_;
  hal::linux_os::IioPlaces places_;
  std::optional<hal::linux_os::IioDevice> device_;
  std::optional<IioAccelerometer> accelerometer_;  ///< a device of its own
  bool is_buffered_ = false;
  bool has_thermometer_ = true;
  double rad_s_per_count_ = 0.0;
  core::Duration period_;
  std::size_t calls_of_verify_ = 0;

  core::Instant started_;
  core::Instant newest_;  ///< stamp of the newest sample; of the start before there is one
  bool has_newest_ = false;
  core::Instant next_;                             ///< when a device without a buffer is read again
  std::optional<hal::linux_os::IioScan> waiting_;  ///< first scan after a gap
  bool is_gap_told_ = false;
  core::Instant temperature_at_;
  std::optional<std::int64_t> temperature_;

  std::string told_;
  int error_number_ = 0;
  bool was_removed_ = false;  ///< the device went away; its driver resets the chip when it returns
};

}  // namespace zerorate::linux_node
