/// @file
/// The recording of a command, and the facts that its files lack.
#pragma once

#include <optional>
#include <string>

#include "core/standstill/standstill.hpp"
#include "host_tools/lib/recording/input.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the library chose the name
class App;
class Option;
}  // namespace CLI

namespace zerorate::cli {

/// Options as typed; to_input() turns them into a recording::Input.
struct InputFlags {
  std::string recording;
  std::string columns;
  std::string units;
  std::string delimiter;
  bool decimal_comma = false;
  std::string where;
  std::size_t skip_lines = 0;
  std::optional<double> rows_at_hz;
  std::string speed_column;
  std::optional<double> still_below_mps;
  std::optional<double> speed_delay_s;
  std::optional<double> track_m;
  std::optional<double> metres_per_pulse;
  std::string odometer_file;
  std::string odometer_columns;
  std::string odometer_units;
  std::string accept;
  std::string topic;
  std::string odometry_topic;
};

/// Adds the options for files of other formats, all of one layout.
void add_format_options(CLI::App& command, InputFlags& flags);

/// Adds RECORDING, which it returns, and the options for a file of another format.
CLI::Option* add_input_options(CLI::App& command, InputFlags& flags);

/// Adds --axis: x, y, z or all.
void add_axis_option(CLI::App& command, std::string& axis);

/// Adds --still-from for commands that want rest alone.
void add_rest_options(CLI::App& command, std::string& still_from);

/// Throws std::invalid_argument that names the option.
[[nodiscard]] recording::Input to_input(const InputFlags& flags);
/// Options of add_format_options() as typed; empty without any.
[[nodiscard]] std::string to_text(const InputFlags& flags);

}  // namespace zerorate::cli
