/// @file
/// Recording of a node's messages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware/wire/rate_frame.hpp"
#include "host_tools/lib/recording/writer.hpp"

namespace zerorate::live {

/// Events of a recording; whatever does not become a row is counted.
struct RecorderCounts {
  std::uint64_t rows = 0;          ///< rows of this session
  std::uint64_t lost = 0;          ///< messages, by gaps in the numbers
  std::uint64_t without_rate = 0;  ///< messages of a gyro that gave no sample, or a refused one
  std::uint64_t out_of_order = 0;  ///< messages that came after later ones, or twice
  std::uint64_t restarts = 0;      ///< restarts of the node
  std::uint64_t pauses = 0;        ///< intervals of more than a second between two rows
  std::uint64_t set_back = 0;      ///< times that the clock stood before the newest row
};

/// Where and what to record.
struct RecorderSettings {
  std::filesystem::path path;
  bool resumes = false;             ///< goes on with the file
  std::optional<std::size_t> axis;  ///< the only one to record: 0 to 2
  std::string comment;              ///< first line of a new file
};

/// Turns messages into the rows of a recording: measured rates, temperature, odometer pulses and
/// acceleration, as far as the messages have them.
///
/// The time of a row is that of the sample, moved to seconds since 1970 by one offset for as long
/// as the node runs. After a restart of the node, and in a file that is continued, the pulse count
/// continues with one more pulse, because the vehicle may have moved meanwhile.
class Recorder {
 public:
  /// Throws recording::Error where a file that is to go on cannot. A new file is made when the
  /// first two seconds of messages have shown which columns it has.
  explicit Recorder(RecorderSettings settings);

  /// @param utc_ns  time by the wall clock at which the message came
  /// Throws recording::Error where the file cannot be made, or lacks a value of the message.
  void take(const wire::NumberedMessage& numbered, std::int64_t utc_ns);
  /// Gives the rows so far to the disk. Throws recording::Error.
  void flush();
  /// flush(), also of a recording of less than two seconds.
  void finish();

  [[nodiscard]] const RecorderCounts& counts() const { return counts_; }
  /// Recorded time of the whole file, without pauses.
  [[nodiscard]] std::int64_t recorded_ns() const { return recorded_ns_; }
  /// Rows of the whole file.
  [[nodiscard]] std::uint64_t rows() const { return held_rows_ + counts_.rows; }
  /// Bytes of an unfinished part that were cut off at the beginning.
  [[nodiscard]] std::uint64_t torn_bytes() const {
    return writer_ ? writer_->held().torn_bytes : 0;
  }

 private:
  static bool has_jumped(const wire::NumberedMessage& before,
                         const wire::NumberedMessage& numbered);
  [[nodiscard]] bool is_borne_out(const wire::NumberedMessage& numbered) const;
  [[nodiscard]] bool follow_number(const wire::NumberedMessage& numbered);
  void anchor(core::Instant time, std::int64_t utc_ns);
  void count_pulses(const app::RateMessage& message);
  [[nodiscard]] recording::Row row_of(const app::RateMessage& message) const;
  void check_columns() const;
  void begin_file();
  void write(const recording::Row& row);

  RecorderSettings settings_;
  std::optional<recording::ContinuedWriter> writer_;
  std::vector<recording::Row> waiting_;  ///< until the columns are known
  bool has_temperature_ = false;
  bool has_pulses_ = false;
  bool has_acceleration_ = false;

  std::optional<wire::NumberedMessage> newest_;
  std::optional<wire::NumberedMessage> doubted_;  ///< newest one whose time jumped
  bool is_anchored_ = false;
  std::int64_t offset_ns_ = 0;  ///< from the node's clock to the row's
  std::optional<std::int64_t> last_time_ns_;
  std::uint32_t node_pulses_ = 0;
  std::int64_t pulses_ = 0;
  std::int64_t recorded_ns_ = 0;
  std::uint64_t held_rows_ = 0;
  RecorderCounts counts_;
};

}  // namespace zerorate::live
