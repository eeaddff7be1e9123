#include "firmware/boards/linux/log_words.hpp"

#include <cerrno>
#include <cstring>

#include "firmware/boards/linux/outputs/sinks.hpp"

namespace zerorate::linux_node {
namespace {

/// A cure of what keeps a node of /dev from being opened.
std::string_view cure_of_device(int error_number) {
  switch (error_number) {
    case ENOENT:
      return " (is the bus enabled, and its name right? zerorate probe)";
    case EACCES:
    case EPERM:
      return " (is the user in the device's group, i2c or spi?)";
    case EBUSY:
      return " (does another program or a driver of the kernel use it?)";
    case ENOTTY:
      return " (is it a node of i2c-dev or spidev?)";
    default:
      return "";
  }
}

}  // namespace

std::string_view cure_of_line(int error_number) {
  switch (error_number) {
    case ENOENT:
    case EINVAL:
      return " (is there such a chip and line? gpioinfo)";
    case EACCES:
    case EPERM:
      return " (is the user in the group gpio?)";
    case EBUSY:
      return " (does another program use the line? gpioinfo)";
    default:
      return "";
  }
}

std::string_view cure_of_speed(int error_number) {
  switch (error_number) {
    case EAFNOSUPPORT:
      return " (has this kernel CAN? modprobe can_raw)";
    case ETIMEDOUT:
      return " (no message with a speed comes: do its sender, identifier and length agree?)";
    case EBADMSG:
      return " (messages come, and none can be used: numbers in m/s, still or moving; of CAN long "
             "enough, counting on and with a valid speed)";
    case ENODATA:
      return " (the vehicle says that its speed is not valid)";
    case EADDRINUSE:
      return " (does another program or node listen there? ss -ulnp)";
    case ENODEV:
      return " (is there such an interface? ip link)";
    case ENETDOWN:
      return " (is the interface up? ip link set NAME up)";
    case ENOENT:
      return " (make the socket's folder first)";
    default:
      return "";
  }
}

std::string_view cure_of_sink(std::string_view sink, int error_number) {
  if (error_number == ENOENT && sink.starts_with("json:")) return " (make its folder first)";
  if (error_number == EINVAL && sink.starts_with("can:")) {
    return " (is the interface set to CAN FD? ip link set NAME type can fd on)";
  }
  switch (error_number) {
    case EAFNOSUPPORT:
      return " (has this kernel CAN? modprobe can_raw)";
    case ENODEV:
      return " (is there such an interface? ip link)";
    case ENETDOWN:
      return " (is the interface up? ip link set NAME up)";
    case ENOENT:
    case ENXIO:
    case ECONNREFUSED:
      return " (does the receiver run?)";
    case EAGAIN:
    case ENOBUFS:
      return " (nobody takes them: does the receiver read, is a node on the bus to acknowledge?)";
    case ECOMM:
      return " (bus-off: are bit rate, wiring and termination right? ip -details link show)";
    default:
      return "";
  }
}

std::string_view describe(const GyroSettings& gyro, const drivers::DriverError& error,
                          const GyroReason& reason, LogBuffer& buffer) {
  using Code = drivers::DriverErrorCode;
  Line line(buffer);
  if (!reason.told.empty()) {
    line.add("{}", reason.told);
    return line.text();
  }
  line.add("{}", gyro.device);
  const bool is_bus = error.code == Code::bus_failed;
  if (is_bus && error.bus == hal::BusError::not_present && reason.error_number != 0) {
    line.add(": {}{}", std::strerror(reason.error_number), cure_of_device(reason.error_number));
    return line.text();
  }
  if (gyro.bus == BusKind::i2c) line.add(" at {:#04x}", gyro.address);
  if (error.code == Code::wrong_identity && reason.identity) {
    line.add(" answered {:#04x}", *reason.identity);
    const ChipDescription* const chip = find_chip(gyro.chip);
    if (chip != nullptr && chip->identity)
      line.add(", {} answers {:#04x}", gyro.chip, *chip->identity);
    line.add(": is it another chip? zerorate probe");
    return line.text();
  }
  line.add(": {}", drivers::name(error.code));
  if (error.code == Code::frozen) {
    line.add(" on axis");
    for (unsigned axis = 0; axis < 3; ++axis) {
      if ((error.reg >> axis & 1U) != 0) line.add(" {}", "xyz"[axis]);
    }
    return line.text();
  }
  if (is_bus) line.add(" ({})", hal::name(error.bus));
  line.add(" at register {:#04x}", error.reg);
  if (is_bus && error.bus == hal::BusError::nack) {
    line.add(" (are the wiring and the address right? zerorate probe)");
  } else if (is_bus && reason.error_number != 0) {
    line.add(": {}{}", std::strerror(reason.error_number), cure_of_device(reason.error_number));
  }
  return line.text();
}

std::string name_of_odometer(const Configuration& configuration) {
  if (configuration.speed) return "odometer " + name_of(configuration.speed->origin);
  if (configuration.odometer) {
    return fmt::format("odometer {} line {}", configuration.odometer->chip,
                       configuration.odometer->line);
  }
  return configuration.gyro.is_simulated() ? "simulated odometer" : "no odometer";
}

std::string describe(const Configuration& configuration) {
  const GyroSettings& gyro = configuration.gyro;
  std::string text = gyro.chip.empty() ? std::string{"gyro"} : gyro.chip;
  if (!gyro.is_simulated()) text += " on " + gyro.device;
  if (gyro.bus == BusKind::i2c) text += fmt::format(" at {:#04x}", gyro.address);
  text += fmt::format(", {} Hz, {} deg/s, model {}, ", gyro.rate_hz, gyro.full_scale_dps,
                      configuration.model_name);
  if (gyro.acceleration_range_g) {
    text += fmt::format("acceleration to {} g, ", *gyro.acceleration_range_g);
  }
  text += name_of_odometer(configuration);
  if (configuration.reference) text += ", reference " + name_of(configuration.reference->origin);
  for (const SinkSettings& sink : configuration.sinks) text += ", " + name_of(sink);
  return text;
}

}  // namespace zerorate::linux_node
