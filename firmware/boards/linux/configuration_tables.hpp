/// @file
/// Parts of reading the configuration that its tables have in common.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/base/time.hpp"
#include "firmware/boards/linux/configuration.hpp"
#include "firmware/toml/error.hpp"
#include "firmware/toml/strict_table.hpp"

namespace zerorate::linux_node {

inline constexpr toml_file::Rule kSeconds{[](double x) { return x >= 0.0 && x <= 1e6; },
                                          "seconds, from 0 to 1 000 000"};

inline constexpr toml_file::Rule kDeadBand{[](double x) { return x >= 0.0 && x <= 10.0; },
                                           "a speed in m/s, from 0 to 10"};

[[nodiscard]] inline core::Duration duration_of(double seconds) {
  return core::Duration::nanoseconds(std::llround(seconds * 1e9));
}

/// A path or a name: text that is not empty and has no control characters, with which it would
/// make lines of its own in logs.
[[nodiscard]] inline std::optional<std::string> name_at(toml_file::StrictTable& table,
                                                        std::string_view key,
                                                        toml_file::Presence presence) {
  auto name = table.text(key, presence);
  if (name && name->empty()) table.fail_at(key, "expected text that is not empty");
  const auto is_control = [](char character) {
    const auto byte = static_cast<unsigned char>(character);
    return byte < 0x20 || byte == 0x7F;
  };
  if (name && std::ranges::any_of(*name, is_control)) {
    table.fail_at(key, "expected text without line breaks and other control characters");
  }
  return name;
}

/// An optional part of the file: read by `read`, then searched for names that nothing asked for.
template <class Read>
void with_table(toml_file::StrictTable& parent, std::string_view key, toml_file::Presence presence,
                toml_file::ErrorList& errors, Read read) {
  errors.attempt([&] {
    if (auto table = parent.table(key, presence)) {
      read(*table);
      table->reject_unknown();
    }
  });
}

/// Reports what `act` finds impossible at a key of the file.
template <class Act>
auto at_key(const toml_file::StrictTable& table, std::string_view key, Act act) {
  try {
    return act();
  } catch (const std::invalid_argument& error) {
    table.fail_at(key, error.what());
  }
}

/// Address and port of a datagram's receiver.
[[nodiscard]] UdpSettings read_udp(toml_file::StrictTable& table);
/// Axis that points up: z unless given.
[[nodiscard]] std::optional<core::UpAxis> read_up(toml_file::StrictTable& table,
                                                  toml_file::Presence presence);
/// Sink of a CAN bus.
/// @param up  becomes the axis that points up, where the table states it
[[nodiscard]] CanSettings read_can(toml_file::StrictTable& table, std::optional<core::UpAxis>& up);
/// Name of a network interface that the kernel can have, at the key `interface`.
[[nodiscard]] std::string read_interface(toml_file::StrictTable& table);
/// Path that a Unix socket can have.
[[nodiscard]] std::string read_socket_path(toml_file::StrictTable& table, std::string_view key);

/// Speeds that messages bring: the table of an odometer that is no line.
/// @param type  "can", "udp" or "unix"
[[nodiscard]] SpeedSettings read_speed(toml_file::StrictTable& table, std::string_view type);
/// Headings that messages bring.
[[nodiscard]] ReferenceSettings read_reference(toml_file::StrictTable& table);

/// Reads the tables of the gyro, of its interrupt, of the odometer and of references.
void read_hardware(toml_file::StrictTable& root, Configuration& configuration,
                   toml_file::ErrorList& errors);

}  // namespace zerorate::linux_node
