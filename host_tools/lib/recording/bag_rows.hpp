/// @file
/// Rows of a ROS 2 bag: an SQLite database of messages in CDR.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/header.hpp"
#include "host_tools/lib/recording/row_source.hpp"

namespace zerorate::recording {

/// The databases of a bag, in the order of their messages: the file itself, or all .db3 files of a
/// folder. Empty where the path is no bag.
[[nodiscard]] std::vector<std::filesystem::path> bag_files(const std::filesystem::path& path);

/// Names of the topics of a bag with such messages. Throws Error.
[[nodiscard]] std::vector<std::string> bag_topics(const std::filesystem::path& file, Needs needs);

/// Reads the messages of one topic: sensor_msgs/Imu for rates, nav_msgs/Odometry for motion, whose
/// speed is that of its twist. A row has the stamp of the message's header, or where that is zero
/// the time at which it was recorded. A rate whose covariance begins with -1 is lost (REP 145).
class BagRows : public RowSource {
 public:
  /// @param files  of bag_files(), at least one
  /// @param topic  empty: the only one with such messages
  /// Throws Error.
  BagRows(std::vector<std::filesystem::path> files, Needs needs, const std::string& topic);
  ~BagRows() override;

  [[nodiscard]] const Columns& columns() const override { return columns_; }
  [[nodiscard]] bool next(Row& row) override;
  [[nodiscard]] std::uint64_t line() const override { return messages_; }
  [[nodiscard]] std::optional<double> fraction_read() const override;

 private:
  struct OpenFile;

  void open_next();
  [[nodiscard]] Row decode(std::int64_t recorded_ns, std::span<const std::byte> message) const;

  std::vector<std::filesystem::path> files_;
  Needs needs_;
  std::string topic_;
  Columns columns_;
  std::unique_ptr<OpenFile> open_;
  std::size_t opened_ = 0;            ///< of the files
  std::uint64_t messages_ = 0;        ///< read so far
  std::uint64_t messages_known_ = 0;  ///< in the files that were opened
};

}  // namespace zerorate::recording
