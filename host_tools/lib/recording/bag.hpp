/// @file
/// A bag of ROS 1 or ROS 2: its topics, and their messages as bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/header.hpp"

namespace zerorate::recording {

/// Rules by which the fields of a message become bytes: CDR (OMG formal/02-06-51, 15.3) in ROS 2,
/// packed fields in little-endian order in ROS 1.
enum class Serialization : std::uint8_t { cdr, ros1 };

/// Types of messages that count. Those of `bias` are not read: their topic shows that the node of
/// ROS has corrected the rates beside it.
enum class MessageType : std::uint8_t { imu, odometry, twist_stamped, twist, bias };

/// Differences between bags of ROS 1 and ROS 2.
struct BagFormat {
  Serialization serialization;
  std::string_view name;                  ///< name of the format, for errors
  std::array<std::string_view, 5> types;  ///< names of MessageType, in its order
  std::string_view info_command;          ///< command that shows the content of a bag

  [[nodiscard]] std::string_view name_of(MessageType type) const {
    return types.at(static_cast<std::size_t>(type));
  }
};

inline constexpr std::array<std::string_view, 5> kRos1Types{
    "sensor_msgs/Imu", "nav_msgs/Odometry", "geometry_msgs/TwistStamped", "geometry_msgs/Twist",
    "geometry_msgs/TwistWithCovarianceStamped"};
inline constexpr std::array<std::string_view, 5> kRos2Types{
    "sensor_msgs/msg/Imu", "nav_msgs/msg/Odometry", "geometry_msgs/msg/TwistStamped",
    "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistWithCovarianceStamped"};

/// Message of a bag.
struct BagMessage {
  std::int64_t recorded_ns = 0;      ///< time of recording since 1970
  std::span<const std::byte> bytes;  ///< until the next message is read
};

/// Gives the messages of one topic. Each function throws Error.
class Bag {
 public:
  virtual ~Bag() = default;

  [[nodiscard]] virtual const BagFormat& format() const = 0;
  /// Names of the topics with messages of a type, in alphabetical order.
  [[nodiscard]] virtual std::vector<std::string> topics(MessageType type) = 0;
  /// Begins with the first message of a topic; gives how many there are.
  virtual std::uint64_t select(const std::string& topic, MessageType type) = 0;
  /// Reads the next message, in the order of recording; false at the end.
  [[nodiscard]] virtual bool next(BagMessage& message) = 0;
  /// File of the message that was read last.
  [[nodiscard]] virtual const std::filesystem::path& file() const = 0;
};

/// Opens a bag: a .db3 or .mcap file, a folder of them, or a .bag file; null where the path is none
/// of them. Throws Error, also for a .bag file where the build lacks the library for it.
[[nodiscard]] std::unique_ptr<Bag> open_bag(const std::filesystem::path& path);

/// Opens the database of a bag of ROS 2, or all of a folder in the order of their messages; null
/// where there is none. Throws Error.
[[nodiscard]] std::unique_ptr<Bag> open_ros2_bag(const std::filesystem::path& path);

/// Opens a bag of ROS 2 in MCAP, or all such files of a folder in the order of their messages; null
/// where there is none. Chunks may be compressed by lz4 and zstd, where the build has the libraries
/// for them. Throws Error.
[[nodiscard]] std::unique_ptr<Bag> open_mcap_bag(const std::filesystem::path& path);

/// Opens a bag of ROS 1. Throws Error, also where the build lacks librosbag-storage.
[[nodiscard]] std::unique_ptr<Bag> open_ros1_bag(const std::filesystem::path& path);

/// Whether a file, which is no pipe, begins with this text.
[[nodiscard]] bool file_begins_with(const std::filesystem::path& file, std::string_view text);

}  // namespace zerorate::recording
