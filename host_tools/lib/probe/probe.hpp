/// @file
/// Search for gyros on a bus, and behind the drivers of the kernel.
///
/// Only identity registers are read, and only their addresses are written: other devices on the bus
/// keep their settings.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/chips/chips.hpp"
#include "drivers/common/chip.hpp"
#include "drivers/common/register_access.hpp"
#include "hal/linux/i2c_dev.hpp"
#include "hal/linux/iio_device.hpp"
#include "hal/linux/spidev.hpp"

namespace zerorate::probe {

/// One chip that was looked for in one place.
struct Attempt {
  std::string_view chip;                ///< name in zerorated.toml
  std::optional<std::uint8_t> address;  ///< on I2C
  bool is_found = false;
  std::string answer;    ///< the identity that was read, or the error of the bus
  int error_number = 0;  ///< errno of a device that could not be used
};

namespace detail {

/// "0x6c"
[[nodiscard]] std::string in_hexadecimal(std::uint32_t value);

template <drivers::RegisterChipEntry Chip, drivers::RegisterBus Bus>
Attempt ask(Bus bus) {
  const auto identity = drivers::read_register(bus, Chip::kIdentity);
  if (!identity) {
    return {.chip = Chip::kName, .answer = std::string{hal::name(identity.error().bus)}};
  }
  return {.chip = Chip::kName,
          .is_found = drivers::takes_identity<Chip>(*identity),
          .answer = in_hexadecimal(*identity)};
}

template <drivers::LateChipEntry Chip, class Bus>
Attempt ask(Bus bus) {
  Attempt attempt{.chip = Chip::kName};
  const auto reply = drivers::ask_identity<Chip>(bus);
  if (!reply) {
    attempt.answer = std::string{hal::name(reply.error())};
    return attempt;
  }
  attempt.is_found = Chip::is_identity(*reply);
  attempt.answer = in_hexadecimal(*reply);
  return attempt;
}

}  // namespace detail

/// Asks the chips on one chip select, at 1 MHz, which all of them take; one transaction a chip with
/// registers, two a chip of frames or words.
///
/// Chips with registers come first: to a chip of frames, their questions are broken frames. Where
/// no chip was found, those of words come last: to a chip with 8-bit registers their question is a
/// write of 0 to register 72h.
/// @param device  e.g. "/dev/spidev0.0"
template <class System = hal::linux_os::SystemCalls>
std::vector<Attempt> probe_spi(const std::string& device, System system = {}) {
  using Spi = hal::linux_os::SpidevDevice<System>;
  std::vector<Attempt> attempts;
  const auto ask = [&]<class Chip> {
    constexpr std::uint32_t kSpeed_hz = 1'000'000;
    Spi spi{{device, kSpeed_hz, Chip::kSpiMode, drivers::kSpiPauseOf<Chip>}, system};
    attempts.push_back(detail::ask<Chip>(drivers::SpiLink<Chip, Spi>{spi}));
    attempts.back().error_number = spi.error_number();
  };
  drivers::AllChips::for_each([&]<class Chip> {
    if constexpr (drivers::RegisterChipEntry<Chip>) ask.template operator()<Chip>();
  });
  drivers::AllChips::for_each([&]<class Chip> {
    if constexpr (drivers::FrameChipEntry<Chip>) ask.template operator()<Chip>();
  });
  if (std::ranges::any_of(attempts, &Attempt::is_found)) return attempts;
  drivers::AllChips::for_each([&]<class Chip> {
    if constexpr (drivers::WordChipEntry<Chip>) ask.template operator()<Chip>();
  });
  return attempts;
}

/// Asks all chips with registers, at all their addresses; one transaction each.
/// @param device  e.g. "/dev/i2c-1"
template <class System = hal::linux_os::SystemCalls>
std::vector<Attempt> probe_i2c(const std::string& device, System system = {}) {
  hal::linux_os::I2cDevBus<System> bus{device, system};
  std::vector<Attempt> attempts;
  drivers::AllChips::for_each([&]<class Chip> {
    if constexpr (drivers::RegisterChipEntry<Chip>) {
      for (const hal::I2cAddress address : Chip::kAddresses) {
        Attempt attempt = detail::ask<Chip>(drivers::I2cRegisters{bus, address});
        attempt.address = static_cast<std::uint8_t>(address);
        attempt.error_number = bus.error_number();
        attempts.push_back(attempt);
      }
    }
  });
  return attempts;
}

/// A bus and what was looked for on it.
struct Bus {
  enum class Kind : std::uint8_t { spi, i2c };
  Kind kind = Kind::spi;
  std::string device;
  std::vector<Attempt> attempts;

  /// Reason why no chip could be asked at all, as the kernel gave it; 0: they could.
  [[nodiscard]] int error_number() const;
};

/// Devices to ask.
struct Devices {
  std::vector<std::string> spi;
  std::vector<std::string> i2c;
};

/// The nodes spidev* and i2c-* of a folder, by name.
[[nodiscard]] Devices find_devices(const std::string& folder);

/// Asks all of them through the kernel. A device that cannot be opened answers "not present".
[[nodiscard]] std::vector<Bus> probe_buses(const Devices& devices);

/// A gyro or an accelerometer behind a driver of the kernel (IIO), as `zerorated.toml` names it.
struct KernelSensor {
  hal::linux_os::IioIdentity identity;
  std::string device;    ///< its name, or "iio:device1" where several have that name
  double rate_hz = 0.0;  ///< sampling rate of the driver now; 0: it gives none
};
/// Those of the kernel. A device that measures both stands in both lists.
struct KernelSensors {
  std::vector<KernelSensor> gyros;
  std::vector<KernelSensor> accelerometers;
};

/// Reads attributes and writes none.
[[nodiscard]] KernelSensors find_kernel_sensors(const hal::linux_os::IioPlaces& places);

/// One line an attempt; one for a device that could not be used, with the kernel's reason. Of a
/// sensor of the kernel the lines that `zerorated.toml` needs.
[[nodiscard]] std::string to_text(const std::vector<Bus>& buses, const KernelSensors& kernel = {});
/// Schema zerorate.probe/1; see docs/reference/probe-json.md.
[[nodiscard]] std::string to_json(const std::vector<Bus>& buses, const KernelSensors& kernel = {});

}  // namespace zerorate::probe
