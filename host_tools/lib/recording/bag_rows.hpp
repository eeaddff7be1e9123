/// @file
/// Rows of a bag of ROS.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "host_tools/lib/recording/bag.hpp"
#include "host_tools/lib/recording/header.hpp"
#include "host_tools/lib/recording/row_source.hpp"

namespace zerorate::recording {

/// Reads the messages of one topic: sensor_msgs/Imu for rates; for motion nav_msgs/Odometry or, if
/// the topic is named, geometry_msgs/TwistStamped or geometry_msgs/Twist. Speed and rate of turn
/// are those of the twist. A row has the stamp of the message's header, or where that is zero the
/// time at which it was recorded. A rate or an acceleration whose covariance begins with -1 is lost
/// (REP 145); a bag whose first message lacks the acceleration has no column of it.
class BagRows : public RowSource {
 public:
  /// @param topic  empty: the only one with such messages
  /// Throws Error.
  BagRows(std::unique_ptr<Bag> bag, Needs needs, const std::string& topic);

  [[nodiscard]] const Columns& columns() const override { return columns_; }
  [[nodiscard]] bool next(Row& row) override;
  [[nodiscard]] std::uint64_t line() const override { return messages_; }
  [[nodiscard]] std::optional<double> fraction_read() const override;

 private:
  [[nodiscard]] Row take_first();
  [[nodiscard]] Row decode(const BagMessage& message, std::uint64_t number) const;

  std::unique_ptr<Bag> bag_;
  std::string topic_;
  MessageType type_ = MessageType::imu;
  Columns columns_;
  std::uint64_t messages_ = 0;  ///< given so far
  std::uint64_t messages_known_ = 0;
  std::optional<Row> first_;  ///< shows the columns; until it is given
};

}  // namespace zerorate::recording
