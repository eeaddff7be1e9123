#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "hal/linux/bus_error.hpp"
#include "host_tools/lib/probe/probe.hpp"

namespace zerorate::probe {

std::string detail::in_hexadecimal(std::uint32_t value) {
  return fmt::format("{:#04x}", value);
}

Devices find_devices(const std::string& folder) {
  Devices devices;
  for (const auto& entry : std::filesystem::directory_iterator{folder}) {
    const std::string name = entry.path().filename();
    if (name.starts_with("spidev")) devices.spi.push_back(entry.path());
    if (name.starts_with("i2c-")) devices.i2c.push_back(entry.path());
  }
  std::ranges::sort(devices.spi);
  std::ranges::sort(devices.i2c);
  return devices;
}

std::vector<Bus> probe_buses(const Devices& devices) {
  std::vector<Bus> buses;
  for (const std::string& device : devices.spi) {
    buses.push_back({Bus::Kind::spi, device, probe_spi(device)});
  }
  for (const std::string& device : devices.i2c) {
    buses.push_back({Bus::Kind::i2c, device, probe_i2c(device)});
  }
  return buses;
}

int Bus::error_number() const {
  using hal::linux_os::Subsystem;
  const Subsystem subsystem = kind == Kind::spi ? Subsystem::spi : Subsystem::i2c;
  const bool is_unusable = std::ranges::all_of(attempts, [&](const Attempt& attempt) {
    const int error = attempt.error_number;
    return error == EBUSY || (error != 0 && hal::linux_os::to_bus_error(error, subsystem) ==
                                                hal::BusError::not_present);
  });
  return attempts.empty() || !is_unusable ? 0 : attempts.front().error_number;
}

namespace {

std::vector<KernelSensor> find_kernel_sensors(const hal::linux_os::IioPlaces& places,
                                              const hal::linux_os::IioQuantity& quantity) {
  std::vector<KernelSensor> sensors;
  const auto identities = hal::linux_os::find_iio_devices(places, quantity);
  for (const auto& identity : identities) {
    const auto namesakes =
        std::ranges::count(identities, identity.name, &hal::linux_os::IioIdentity::name);
    const bool is_clear = namesakes == 1 && !identity.name.empty();
    const hal::linux_os::SysfsFolder folder{places.sysfs + "/" + identity.node};
    const auto rate = hal::linux_os::rate_attribute(folder, quantity);
    sensors.push_back({.identity = identity,
                       .device = is_clear ? identity.name : identity.node,
                       .rate_hz = rate ? folder.number(*rate) : 0.0});
  }
  return sensors;
}

nlohmann::ordered_json as_json(const std::vector<KernelSensor>& sensors) {
  auto entries = nlohmann::ordered_json::array();
  for (const KernelSensor& sensor : sensors) {
    entries.push_back({{"node", sensor.identity.node},
                       {"name", sensor.identity.name},
                       {"label", sensor.identity.label},
                       {"device", sensor.device},
                       {"rate_hz", sensor.rate_hz}});
  }
  return entries;
}

}  // namespace

KernelSensors find_kernel_sensors(const hal::linux_os::IioPlaces& places) {
  return {.gyros = find_kernel_sensors(places, hal::linux_os::kIioRate),
          .accelerometers = find_kernel_sensors(places, hal::linux_os::kIioAcceleration)};
}

std::string to_text(const std::vector<Bus>& buses, const KernelSensors& kernel) {
  std::string text;
  for (const Bus& bus : buses) {
    if (const int error = bus.error_number(); error != 0) {
      const bool is_forbidden = error == EACCES || error == EPERM;
      const std::string_view cure =
          is_forbidden     ? " (is the user in the device's group, i2c or spi?)"
          : error == EBUSY ? " (another program reads the chip, zerorated perhaps)"
                           : "";
      text += fmt::format("{:<20} {}{}\n", bus.device, std::strerror(error), cure);
      continue;
    }
    for (const Attempt& attempt : bus.attempts) {
      const std::string place =
          attempt.address ? fmt::format("{} at {:#04x}", bus.device, *attempt.address) : bus.device;
      text += fmt::format("{:<20} {:<11} {:<5} {}\n", place, attempt.chip,
                          attempt.is_found ? "found" : "no", attempt.answer);
    }
  }
  for (const KernelSensor& gyro : kernel.gyros) {
    text += fmt::format(
        "{:<20} {} found, by a driver of the kernel. In zerorated.toml:\n"
        "    [gyro]\n    bus = \"iio\"\n    device = \"{}\"\n    rate_hz = {:g}\n",
        gyro.identity.node, gyro.identity.name, gyro.device, gyro.rate_hz);
  }
  for (const KernelSensor& accelerometer : kernel.accelerometers) {
    text += fmt::format(
        "{:<20} {} found, an accelerometer. Below a [gyro] of the kernel:\n"
        "    acceleration = true\n    accelerometer_device = \"{}\"\n",
        accelerometer.identity.node, accelerometer.identity.name, accelerometer.device);
  }
  return text;
}

std::string to_json(const std::vector<Bus>& buses, const KernelSensors& kernel) {
  nlohmann::ordered_json document{{"schema", "zerorate.probe/1"},
                                  {"buses", nlohmann::ordered_json::array()},
                                  {"kernel", as_json(kernel.gyros)},
                                  {"kernel_accelerometers", as_json(kernel.accelerometers)}};
  for (const Bus& bus : buses) {
    nlohmann::ordered_json attempts = nlohmann::ordered_json::array();
    for (const Attempt& attempt : bus.attempts) {
      nlohmann::ordered_json entry{{"chip", attempt.chip}};
      if (attempt.address) entry["address"] = *attempt.address;
      entry["found"] = attempt.is_found;
      entry["answer"] = attempt.answer;
      attempts.push_back(std::move(entry));
    }
    document["buses"].push_back({{"device", bus.device},
                                 {"bus", bus.kind == Bus::Kind::spi ? "spi" : "i2c"},
                                 {"attempts", std::move(attempts)}});
  }
  return document.dump(2) + "\n";
}

}  // namespace zerorate::probe
