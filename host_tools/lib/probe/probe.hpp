/// @file
/// Which gyro answers on a bus.
///
/// Only identity registers are read, and nothing is written but the address of the register that is
/// asked for: whatever else listens keeps its settings.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/adxrs453/codec.hpp"
#include "drivers/bmi088/registers.hpp"
#include "drivers/common/frame_bus.hpp"
#include "drivers/common/register_access.hpp"
#include "drivers/common/register_bus.hpp"
#include "drivers/icm42688/registers.hpp"
#include "drivers/lsm6dso/registers.hpp"
#include "hal/linux/i2c_dev.hpp"
#include "hal/linux/spidev.hpp"

namespace zerorate::probe {

/// One chip that was looked for in one place.
struct Attempt {
  std::string_view chip;                ///< as in zerorated.toml
  std::optional<std::uint8_t> address;  ///< on I2C
  bool is_found = false;
  std::string answer;  ///< the identity that was read, or what the bus said
};

namespace detail {

/// "0x6c"
[[nodiscard]] std::string in_hexadecimal(std::uint32_t value);

template <drivers::RegisterBus Bus, class WhoAmI>
Attempt ask(std::string_view chip, Bus bus, WhoAmI who_am_i) {
  const auto identity = drivers::read_register(bus, who_am_i);
  if (!identity) return {.chip = chip, .answer = std::string{hal::name(identity.error().bus)}};
  return {
      .chip = chip, .is_found = *identity == who_am_i.reset, .answer = in_hexadecimal(*identity)};
}

/// The reply to a frame comes with the next one; the same frame twice asks once more, for nothing.
template <drivers::FrameBus Bus>
Attempt ask_adxrs453(Bus bus) {
  namespace chip = drivers::adxrs453;
  constexpr std::uint32_t kRead = chip::encode_read(chip::kPid1);
  static_assert(kRead >> 31U == 1, "to chips with registers, this is a read too");
  Attempt attempt{.chip = "adxrs453"};
  if (const auto sent = bus.exchange(kRead); !sent) {
    attempt.answer = std::string{hal::name(sent.error())};
    return attempt;
  }
  const auto reply = bus.exchange(kRead);
  if (!reply) {
    attempt.answer = std::string{hal::name(reply.error())};
    return attempt;
  }
  attempt.is_found = chip::has_good_parity(*reply) && chip::is_read_reply(*reply) &&
                     chip::decode_read_data(*reply) >> 8U == chip::kPartId;
  attempt.answer = in_hexadecimal(*reply);
  return attempt;
}

/// Calls ask(name, identity register, addresses) for each chip that has registers.
template <class Ask>
void for_each_register_chip(Ask ask) {
  using Addresses = std::array<hal::I2cAddress, 2>;
  ask("bmi088", drivers::bmi088::kGyroChipId,
      Addresses{drivers::bmi088::kAddressSdo2Low, drivers::bmi088::kAddressSdo2High});
  ask("icm42688", drivers::icm42688::kWhoAmI,
      Addresses{drivers::icm42688::kAddressAd0Low, drivers::icm42688::kAddressAd0High});
  ask("lsm6dso", drivers::lsm6dso::kWhoAmI,
      Addresses{drivers::lsm6dso::kAddressSa0Low, drivers::lsm6dso::kAddressSa0High});
}

}  // namespace detail

/// All chips, on one chip select. At 1 MHz, which all of them take; five transactions.
/// @param device  e.g. "/dev/spidev0.0"
template <class System = hal::linux_os::SystemCalls>
std::vector<Attempt> probe_spi(const std::string& device, System system = {}) {
  using Spi = hal::linux_os::SpidevDevice<System>;
  std::vector<Attempt> attempts;
  Spi registers{{.device = device, .mode = 3}, system};
  detail::for_each_register_chip([&](std::string_view chip, auto who_am_i, const auto&) {
    attempts.push_back(detail::ask(chip, drivers::SpiRegisters{registers}, who_am_i));
  });
  Spi frames{{.device = device, .mode = 0}, system};
  attempts.push_back(detail::ask_adxrs453(drivers::SpiFrames{frames}));
  return attempts;
}

/// All chips at all their addresses; six transactions.
/// @param device  e.g. "/dev/i2c-1"
template <class System = hal::linux_os::SystemCalls>
std::vector<Attempt> probe_i2c(const std::string& device, System system = {}) {
  hal::linux_os::I2cDevBus<System> bus{device, system};
  std::vector<Attempt> attempts;
  detail::for_each_register_chip([&](std::string_view chip, auto who_am_i, const auto& addresses) {
    for (const hal::I2cAddress address : addresses) {
      Attempt attempt = detail::ask(chip, drivers::I2cRegisters{bus, address}, who_am_i);
      attempt.address = static_cast<std::uint8_t>(address);
      attempts.push_back(attempt);
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

/// One line an attempt.
[[nodiscard]] std::string to_text(const std::vector<Bus>& buses);
/// Schema zerorate.probe/1; see docs/reference/probe-json.md.
[[nodiscard]] std::string to_json(const std::vector<Bus>& buses);

}  // namespace zerorate::probe
