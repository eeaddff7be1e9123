/// @file
/// Source of a recording, and the facts that its files lack.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "core/base/time.hpp"
#include "host_tools/lib/recording/layout.hpp"

namespace zerorate::recording {

/// Rule by which the speed of a vehicle decides that it stands.
struct SpeedRule {
  double dead_band_m_s = 0.0;  ///< a greater speed, forwards or backwards, is motion
  core::Duration delay;        ///< from the motion to the stamp of its speed
  /// Distance of the wheels of an axle. A rate of turn counts as the speed at half of it. The
  /// default is wide for a robot that turns on the spot: too wide loses rest, too narrow takes a
  /// slow turn for rest.
  double track_m = 1.0;
  std::optional<double> metres_per_pulse;  ///< makes pulses of the distance instead of still
};

/// A recording as the user names it. A path alone is enough for files in zerorate's own format.
struct Input {
  std::filesystem::path path;  ///< "-" is standard input; a folder of EuRoC or of a ROS 2 bag
  Layout layout;
  std::optional<SpeedRule> speed;       ///< nullopt: any speed but 0 is motion, without delay
  std::filesystem::path odometer_path;  ///< empty: the odometer is in `path`, if anywhere
  Layout odometer_layout;
  std::string accepted;        ///< doubts that are wrong, by their names: "counts,motion"
  std::string topic;           ///< topic of sensor_msgs/Imu in a bag; empty: the only one
  std::string odometry_topic;  ///< topic of the speed in a bag; empty: the only nav_msgs/Odometry

  Input() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): a path is the usual case
  Input(std::filesystem::path file) : path(std::move(file)) {}
  Input(const char* file) : path(file) {}         // NOLINT(google-explicit-constructor)
  Input(const std::string& file) : path(file) {}  // NOLINT(google-explicit-constructor)
};

}  // namespace zerorate::recording
