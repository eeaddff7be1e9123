#include "firmware/boards/linux/linux_hardware.hpp"

#include <poll.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <ctime>
#include <utility>

#include "hal/linux/clock.hpp"

namespace zerorate::linux_node {

namespace {

drivers::Repetition repetition_of(const Configuration& configuration) {
  const GyroSettings& gyro = configuration.gyro;
  const float variance = configuration.node.model.white_variance_rad2_s2;
  const core::AngularRate sigma = core::rad_per_s(std::sqrt(variance));
  const ChipDescription* const chip = find_chip(gyro.chip);
  // Counts at full scale of a chip that is not known: the fewest of those with 16 bits, because a
  // coarser LSB repeats itself longer.
  constexpr double kFewestCounts = 250.0 / 0.00875;
  const double lsb_dps = gyro.full_scale_dps / (chip != nullptr ? chip->counts : kFewestCounts);
  return drivers::Repetition{
      longest_repetition(static_cast<double>(sigma.in(core::deg_per_s)), lsb_dps, gyro.rate_hz)};
}

}  // namespace

LinuxHardware::LinuxHardware(const Configuration& configuration)
    : LinuxHardware(configuration, make_gyro(configuration.gyro)) {}

LinuxHardware::LinuxHardware(const Configuration& configuration, std::unique_ptr<DeviceGyro> device)
    : device_(*device), gyro_(std::move(device), repetition_of(configuration)) {
  if (configuration.odometer) odometer_.emplace(*configuration.odometer);
  if (configuration.speed) speed_.emplace(*configuration.speed);
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
  return {.gyro = device_.reason(code), .odometer_error_number = odometer_error_number_};
}

core::Instant LinuxHardware::now() const {
  return hal::linux_os::KernelClock::now();
}

std::optional<core::Instant> LinuxHardware::take_edge() {
  if (!data_ready_) return std::nullopt;
  const auto edge = data_ready_->edge.take_edge();
  if (edge) data_ready_->newest = *edge;
  return edge;
}

core::Duration LinuxHardware::longest_wait() const {
  const core::Duration period = gyro_.sample_period();
  if (gyro_.is_batched()) return period * 4;
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
      {.fd = device_.descriptor(), .events = POLLIN, .revents = 0},
  }};
  (void)ppoll(sources.data(), sources.size(), &limit, nullptr);
  wake_.clear();
}

void LinuxHardware::wake() {
  wake_.signal();
}

}  // namespace zerorate::linux_node
