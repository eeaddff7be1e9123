#include "host_tools/cli/input_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <stdexcept>

#include "host_tools/lib/identify/rest_doubt.hpp"

namespace zerorate::cli {
namespace {

/// Runs what reads an option's text, and names the option in what it refuses.
template <class Take>
void read_option(const char* option, const std::string& text, Take take) {
  if (text.empty()) return;
  try {
    take(text);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(fmt::format("{}: {}", option, error.what()));
  }
}

}  // namespace

void add_format_options(CLI::App& command, InputFlags& flags) {
  const auto add = [&](const char* name, auto& value, const char* help) {
    return command.add_option(name, value, help)->group("Files of other formats");
  };
  add("--columns", flags.columns,
      "names of the columns: t=NAME,gx=NAME,gy=NAME,gz=NAME; also t_ns or t_us (ns or us beside "
      "seconds), "
      "rate (a single axis), temp, ax, "
      "ay, az, pulses, ticks1 to ticks4 (wheels, also backwards), still, speed, turn (of the "
      "vehicle "
      "by its wheels), ref_heading, ref_rate, ref_speed; #3 is the third column");
  add("--units", flags.units,
      "units that names do not give: time=s|ms|us|ns|iso, "
      "rate=dps|radps|mdps|dph|0.00875dps (raw counts)|deg/sample|rad/sample, temp=c|k|f, "
      "acceleration=mps2|g, speed=mps|kmh|mph, angle=deg|rad");
  add("--delimiter", flags.delimiter,
      ", ; | tab or space; default: the first of comma, semicolon and tab in the header");
  command.add_flag("--decimal-comma", flags.decimal_comma, "decimals are written as in 0,5")
      ->group("Files of other formats");
  add("--where", flags.where,
      "text that columns must have: COLUMN=VALUE,...; other rows are of another sensor");
  add("--skip-lines", flags.skip_lines, "lines before the header");
  add("--rows-at", flags.rows_at_hz, "rate of the rows in Hz; their stamps do not count")
      ->check(CLI::PositiveNumber);
  add("--speed-column", flags.speed_column,
      "speed of the vehicle, which decides what is rest; in the odometer's file if there is one");
  add("--still-below", flags.still_below_mps, "a greater speed is motion [m/s]; default 0")
      ->check(CLI::Range(0.0, 10.0));
  add("--speed-delay", flags.speed_delay_s,
      "from the motion to the stamp of its speed [s]; default 0")
      ->check(CLI::Range(0.0, 60.0));
  add("--track-width", flags.track_m,
      "distance of left and right wheels [m], by whose half a rate of turn counts as speed; "
      "default "
      "1")
      ->check(CLI::Range(0.01, 100.0));
  add("--metres-per-pulse", flags.metres_per_pulse, "make odometer pulses of the speed [m]")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--accept", flags.accept,
                  "what looks wrong at rest and is right, as the refusal names it: " +
                      identify::doubt_names() + "; several with commas")
      ->group("Files of other formats");
  add("--topic", flags.topic, "topic of sensor_msgs/Imu in a bag; default: the only one");
  add("--odometry-topic", flags.odometry_topic,
      "topic of nav_msgs/Odometry, geometry_msgs/TwistStamped or geometry_msgs/Twist in a bag, "
      "whose "
      "speed and turn decide what is rest; default: the only Odometry, if any");
}

CLI::Option* add_input_options(CLI::App& command, InputFlags& flags) {
  CLI::Option* const recording =
      command
          .add_option("RECORDING", flags.recording,
                      "CSV or CSV.gz file, folder of EuRoC or KITTI, bag of ROS "
                      "2 (.mcap, .db3 or its folder) or ROS 1 (.bag); "
                      "- for standard input")
          ->required();
  add_format_options(command, flags);
  const auto add = [&](const char* name, auto& value, const char* help) {
    return command.add_option(name, value, help)->group("Files of other formats");
  };
  CLI::Option* const file =
      add("--odometer-file", flags.odometer_file,
          "pulses, still or speed at a rate of their own, by the clock of the recording");
  add("--odometer-columns", flags.odometer_columns, "its columns: t=NAME,speed=NAME")->needs(file);
  add("--odometer-units", flags.odometer_units, "its units: time=ns,speed=kmh")->needs(file);
  return recording;
}

void add_axis_option(CLI::App& command, std::string& axis) {
  command.add_option("--axis", axis, "x, y, z or all")
      ->check(CLI::IsMember({"x", "y", "z", "all"}))
      ->capture_default_str();
}

void add_rest_options(CLI::App& command, std::string& still_from) {
  command
      .add_option("--still-from", still_from,
                  "source of rest: odometer (pulses, still or speed; without them all "
                  "is rest) or "
                  "gyro (its own calm)")
      ->check(CLI::IsMember({"odometer", "gyro"}))
      ->capture_default_str();
}

recording::Input to_input(const InputFlags& flags) {
  recording::Input input{flags.recording};
  input.odometer_path = flags.odometer_file;
  input.topic = flags.topic;
  input.odometry_topic = flags.odometry_topic;
  using Text = const std::string&;
  read_option("--columns", flags.columns, [&](Text text) { input.layout.set_columns(text); });
  read_option("--units", flags.units, [&](Text text) { input.layout.set_units(text); });
  read_option("--delimiter", flags.delimiter, [&](Text text) { input.layout.set_delimiter(text); });
  read_option("--where", flags.where, [&](Text text) { input.layout.set_where(text); });
  read_option("--accept", flags.accept, [&](Text text) {
    static_cast<void>(identify::AcceptedDoubts{text});
    input.accepted = text;
  });
  input.layout.skipped_lines = flags.skip_lines;
  input.layout.rows_at_hz = flags.rows_at_hz;
  input.layout.decimal_comma = flags.decimal_comma;
  read_option("--odometer-columns", flags.odometer_columns,
              [&](Text text) { input.odometer_layout.set_columns(text); });
  read_option("--odometer-units", flags.odometer_units,
              [&](Text text) { input.odometer_layout.set_units(text); });
  if (!flags.speed_column.empty()) {
    auto& layout = input.odometer_path.empty() ? input.layout : input.odometer_layout;
    if (!layout.columns.emplace("speed", flags.speed_column).second) {
      throw std::invalid_argument("--speed-column: the column of the speed is given twice");
    }
  }
  if (flags.still_below_mps || flags.speed_delay_s || flags.metres_per_pulse || flags.track_m) {
    input.speed = recording::SpeedRule{
        .dead_band_m_s = flags.still_below_mps.value_or(0.0),
        .delay = core::Duration::nanoseconds(std::llround(flags.speed_delay_s.value_or(0.0) * 1e9)),
        .track_m = flags.track_m.value_or(recording::SpeedRule{}.track_m),
        .metres_per_pulse = flags.metres_per_pulse};
  }
  return input;
}

std::string to_text(const InputFlags& flags) {
  std::string text;
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) text += fmt::format("{}{} {}", text.empty() ? "" : " ", option, value);
  };
  const auto number = [](const std::optional<double>& value) {
    return value ? fmt::format("{}", *value) : std::string{};
  };
  add("--columns", flags.columns);
  add("--units", flags.units);
  add("--delimiter", flags.delimiter);
  add("--decimal-comma", flags.decimal_comma ? "yes" : "");
  add("--where", flags.where);
  add("--skip-lines", flags.skip_lines == 0 ? "" : std::to_string(flags.skip_lines));
  add("--rows-at", number(flags.rows_at_hz));
  add("--accept", flags.accept);
  add("--speed-column", flags.speed_column);
  add("--still-below", number(flags.still_below_mps));
  add("--speed-delay", number(flags.speed_delay_s));
  add("--track-width", number(flags.track_m));
  add("--metres-per-pulse", number(flags.metres_per_pulse));
  add("--topic", flags.topic);
  add("--odometry-topic", flags.odometry_topic);
  return text;
}

}  // namespace zerorate::cli
