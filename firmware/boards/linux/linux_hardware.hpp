/// @file
/// The hardware that a configuration names.
#pragma once

#include <memory>
#include <optional>

#include "firmware/boards/linux/chips/gyro.hpp"
#include "firmware/boards/linux/configuration.hpp"
#include "firmware/boards/linux/datagram_gyro.hpp"
#include "firmware/boards/linux/hardware.hpp"
#include "firmware/boards/linux/process/event.hpp"
#include "hal/linux/gpio_line.hpp"

namespace zerorate::linux_node {

/// A gyro on spidev, i2c-dev or IIO, and lines of GPIO chips.
class LinuxHardware final : public Hardware {
 public:
  explicit LinuxHardware(const Configuration& configuration);

  [[nodiscard]] drivers::AnyGyro& gyro() override { return *gyro_; }
  core::Result<hal::PulseBatch, hal::BusError> read_pulses(
      std::span<core::Instant> stamps) override;
  std::optional<core::Instant> take_edge() override;
  [[nodiscard]] std::optional<Reference> next_reference() override;
  [[nodiscard]] int reference_error_number() const override {
    return references_ ? references_->error_number() : 0;
  }
  [[nodiscard]] SampleCounters sample_counters() const override {
    return by_message_ != nullptr ? by_message_->counters() : SampleCounters{};
  }
  HardwareReasons reasons(drivers::DriverErrorCode code) override;
  [[nodiscard]] core::Instant now() const override;
  [[nodiscard]] core::Duration slept() const override;

  /// For at most two sample periods while data-ready edges come, for four of a gyro with a FIFO.
  /// Without edges (no line, a broken wire, a gyro that does not run) for half a period: then the
  /// gyro is read by the clock.
  void wait() override;
  void wake() override;

 private:
  struct DataReadyLine {
    explicit DataReadyLine(const hal::linux_os::LineSettings& settings) : line(settings) {}
    hal::linux_os::GpioLine line;
    hal::linux_os::LatestEdge<hal::linux_os::GpioLine> edge{line};
    core::Instant newest;
  };

  [[nodiscard]] core::Duration longest_wait() const;

  std::unique_ptr<DeviceGyro> gyro_;
  const DatagramGyro* by_message_;  ///< the gyro, if it is one
  std::optional<hal::linux_os::GpioLine> odometer_;
  std::optional<SpeedSource> speed_;  ///< in its place
  std::optional<ReferenceSource> references_;
  std::optional<DataReadyLine> data_ready_;
  int odometer_error_number_ = 0;
  Event wake_;
};

}  // namespace zerorate::linux_node
