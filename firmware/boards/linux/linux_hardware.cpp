#include "firmware/boards/linux/linux_hardware.hpp"

#include <poll.h>

#include <array>
#include <cerrno>
#include <ctime>

#include "hal/linux/clock.hpp"

namespace zerorate::linux_node {

namespace {

std::unique_ptr<DeviceGyro> make(const Configuration& configuration) {
  if (!configuration.samples) return make_gyro(configuration.gyro);
  return std::make_unique<DatagramGyro>(configuration.gyro, *configuration.samples);
}

}  // namespace

LinuxHardware::LinuxHardware(const Configuration& configuration)
    : gyro_(make(configuration)),
      by_message_(configuration.samples ? static_cast<DatagramGyro*>(gyro_.get()) : nullptr) {
  if (configuration.odometer) odometer_.emplace(*configuration.odometer);
  if (configuration.speed) speed_.emplace(*configuration.speed);
  if (configuration.reference) references_.emplace(*configuration.reference);
  if (configuration.data_ready) data_ready_.emplace(*configuration.data_ready);
}

core::Result<hal::PulseBatch, hal::BusError> LinuxHardware::read_pulses(
    std::span<core::Instant> stamps) {
  if (speed_) {
    auto pulses = speed_->read_pulses(stamps);
    if (!pulses) odometer_error_number_ = speed_->error_number();
    return pulses;
  }
  if (!odometer_) return hal::PulseBatch{};
  auto pulses = odometer_->read_pulses(stamps);
  if (!pulses) odometer_error_number_ = errno;  // libgpiod's functions leave the reason there
  return pulses;
}

HardwareReasons LinuxHardware::reasons(drivers::DriverErrorCode code) {
  return {.gyro = gyro_->reason(code), .odometer_error_number = odometer_error_number_};
}

core::Instant LinuxHardware::now() const {
  return hal::linux_os::KernelClock::now();
}

core::Duration LinuxHardware::slept() const {
  return hal::linux_os::KernelClock::slept();
}

std::optional<core::Instant> LinuxHardware::take_edge() {
  if (!data_ready_) return std::nullopt;
  const auto edge = data_ready_->edge.take_edge();
  if (edge) data_ready_->newest = *edge;
  return edge;
}

std::optional<Reference> LinuxHardware::next_reference() {
  return references_ ? references_->next(now()) : std::nullopt;
}

core::Duration LinuxHardware::longest_wait() const {
  const core::Duration period = gyro_->sample_period();
  if (gyro_->is_batched()) return period * 4;
  const bool edges_come = data_ready_ && now() - data_ready_->newest < period * 4;
  return edges_come ? period * 2 : period / 2;
}

void LinuxHardware::wait() {
  const core::Duration at_most = longest_wait();
  // On 32-bit processors the fields are narrower.
  const std::timespec limit{.tv_sec = static_cast<std::time_t>(at_most.ns() / 1'000'000'000),
                            .tv_nsec = static_cast<long>(at_most.ns() % 1'000'000'000)};
  // A negative descriptor, of a line that is not open, is passed over by the kernel.
  std::array<pollfd, 5> sources{{
      {.fd = wake_.descriptor(), .events = POLLIN, .revents = 0},
      {.fd = odometer_ ? odometer_->descriptor() : -1, .events = POLLIN, .revents = 0},
      {.fd = speed_ ? speed_->descriptor() : -1, .events = POLLIN, .revents = 0},
      {.fd = data_ready_ ? data_ready_->line.descriptor() : -1, .events = POLLIN, .revents = 0},
      {.fd = gyro_->descriptor(), .events = POLLIN, .revents = 0},
  }};
  (void)ppoll(sources.data(), sources.size(), &limit, nullptr);
  wake_.clear();
}

void LinuxHardware::wake() {
  wake_.signal();
}

}  // namespace zerorate::linux_node
