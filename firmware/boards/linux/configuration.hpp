/// @file
/// What zerorated is told: schema `zerorate.daemon/1`; see docs/reference/zerorated.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "firmware/app/gyro_node.hpp"
#include "firmware/boards/linux/gyro.hpp"
#include "firmware/model/node_model.hpp"
#include "hal/linux/gpio_line.hpp"

namespace zerorate::linux_node {

inline constexpr std::string_view kConfigurationSchema = "zerorate.daemon/1";
inline constexpr const char* kConfigurationFile = "/etc/zerorate/zerorated.toml";

/// Large enough for every model that a file can hold.
using Node = app::GyroNode<model::kLargestShape, app::NodeCapacity{.screens_samples = true}>;

/// JSON lines, to a file or, with "-", to the standard output.
struct JsonSettings {
  std::string file;
};
/// Rate frames as datagrams.
struct UdpSettings {
  std::string address;  ///< numeric, IPv4 or IPv6
  std::uint16_t port = 0;
};
struct UnixSettings {
  std::string path;
};
struct CanSettings {
  std::string interface;
  std::uint16_t id = 0;  ///< of the status frame
};
using SinkSettings = std::variant<JsonSettings, UdpSettings, UnixSettings, CanSettings>;

struct StateSettings {
  std::string file;  ///< FILE.0 and FILE.1 are written
  core::Duration save_interval;
};

struct MetricsSettings {
  std::string file;    ///< written once a second; empty: not
  std::string socket;  ///< each connection is given the text; empty: none
};

struct RealTimeSettings {
  int priority = 0;  ///< of the measuring thread, SCHED_FIFO; 0: an ordinary thread
  bool lock_memory = true;
};

struct Configuration {
  std::string user;  ///< to become after the start as root; empty: stay
  GyroSettings gyro;
  std::optional<hal::linux_os::LineSettings> data_ready;
  hal::linux_os::LineSettings odometer;
  Node::Params node;
  std::optional<StateSettings> state;
  MetricsSettings metrics;
  RealTimeSettings real_time;
  std::vector<SinkSettings> sinks;
};

/// Strict: an unknown name, a wrong type, a missing key and an impossible value are
/// toml_file::Errors, with file, line, column and what was expected.
/// @param origin  the file's name in messages
[[nodiscard]] Configuration parse_configuration(std::string_view toml, std::string_view origin);

/// Throws toml_file::Error; std::system_error where the file cannot be read.
[[nodiscard]] Configuration read_configuration(const std::string& file);

}  // namespace zerorate::linux_node
