/// @file
/// Configuration of zerorated, schema `zerorate.daemon/1`; see docs/reference/zerorated.md.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/standstill/odometer_traits.hpp"
#include "firmware/app/gyro_node.hpp"
#include "firmware/boards/linux/chips/gyro.hpp"
#include "firmware/boards/linux/outputs/metrics_endpoint.hpp"
#include "firmware/boards/linux/outputs/sink_settings.hpp"
#include "firmware/boards/linux/process/process.hpp"
#include "firmware/boards/linux/reference_source.hpp"
#include "firmware/boards/linux/speed_source.hpp"
#include "firmware/model/node_model.hpp"
#include "hal/linux/gpio_line.hpp"

namespace zerorate::linux_node {

inline constexpr std::string_view kConfigurationSchema = "zerorate.daemon/1";
inline constexpr const char* kConfigurationFile = "/etc/zerorate/zerorated.toml";

/// Large enough for every model that a file can hold.
using Node = app::GyroNode<model::kWidestLearningShape, app::NodeCapacity{.screens_samples = true}>;

struct StateSettings {
  std::string file;  ///< FILE.0 and FILE.1 are written
  core::Duration save_interval;
};

struct Configuration {
  std::string name;  ///< name of the node in lines and metrics; empty: it is the only one
  std::string user;  ///< user of the process after a start as root; empty: unchanged
  GyroSettings gyro;
  std::optional<MessageOrigin> samples;  ///< origin of the samples that another program sends
  std::optional<hal::linux_os::LineSettings> data_ready;
  std::optional<hal::linux_os::LineSettings> odometer;  ///< on a GPIO line
  std::optional<SpeedSettings>
      speed;  ///< in place of the line; without both the gyro alone decides what is rest
  core::OdometerTraits odometer_traits;
  std::optional<ReferenceSettings> reference;
  std::string model_name;           ///< name of the catalogue, or file
  bool states_scale_factor = true;  ///< false: the model leaves the default tolerance
  Node::Params node;
  std::optional<StateSettings> state;
  MetricsSettings metrics;
  RealTimeSettings real_time;
  std::vector<SinkSettings> sinks;
  std::optional<core::UpAxis> up;  ///< axis that points up, where a sink states it
};

/// Strict: an unknown name, a wrong type, a missing key and an impossible value are
/// toml_file::Errors, with file, line, column and what was expected.
/// @param origin  the file's name in messages
[[nodiscard]] Configuration parse_configuration(std::string_view toml, std::string_view origin);

/// Throws toml_file::Error; std::system_error where the file cannot be read.
[[nodiscard]] Configuration read_configuration(const std::string& file);

/// Configurations of the nodes of one process. A node among several has a name: where its file
/// gives none, that of the file without its folder and ending. Besides what read_configuration()
/// throws, std::invalid_argument where two nodes have one name or two files name two users.
[[nodiscard]] std::vector<Configuration> read_configurations(const std::vector<std::string>& files);

}  // namespace zerorate::linux_node
