/// @file
/// Writers of recordings: one that ends with a whole file, and one that an interruption cannot
/// harm.
#pragma once

#include <zlib.h>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "host_tools/lib/output/appended_file.hpp"
#include "host_tools/lib/output/output_file.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/row.hpp"

namespace zerorate::recording {

/// Appends the line of a row, with its line end: times with all their nanoseconds, every other
/// number with as few digits as reading the same bits back takes.
void append_row(std::string& text, const Columns& columns, const Row& row);

/// Writes a recording: gzip if the name ends in .gz, plain CSV otherwise. The file appears under
/// its name, replacing an older one, when finish() has succeeded; without finish() nothing stays
/// (see output::OutputFile). Only regular files are written: a recording is there to be read again.
///
/// Reader reads back exactly the values that were written, bit for bit (a NaN as some NaN; findings
/// are not written): times with all their nanoseconds, every other number with as few digits as
/// that takes.
class Writer {
 public:
  /// Throws Error if the file cannot be made.
  Writer(const std::filesystem::path& path, const Columns& columns);
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// Appends a row; Row::findings is ignored. Throws Error, as when the disk is full.
  void write(const Row& row);

  /// Completes the file and gives it its name. No write() may follow. Throws Error.
  void finish();

 private:
  struct Closer {
    void operator()(gzFile file) const { static_cast<void>(gzclose(file)); }
  };

  void flush();
  [[nodiscard]] Error cannot(std::string_view action, const std::error_code& fault) const;

  std::filesystem::path path_;
  Columns columns_;
  std::optional<output::OutputFile> file_;
  std::unique_ptr<gzFile_s, Closer> compressor_;
  std::string text_;  ///< formatted but not yet given to zlib
};

/// Content of a recording that is to go on.
struct HeldRecording {
  std::uint64_t rows = 0;
  std::int64_t last_time_ns = 0;
  std::int64_t last_odometer_pulses = 0;
  std::int64_t recorded_ns = 0;  ///< sum of the intervals that are no pauses
  std::uint64_t torn_bytes = 0;  ///< bytes of an unfinished part at the end, which were cut off
};

/// An interval between two rows that is longer is a pause of the recording, not recorded time.
inline constexpr std::int64_t kLongestInterval_ns = 1'000'000'000;

/// Writes a recording in whole parts: each flush() appends one gzip member (or, unless the name
/// ends in .gz, plain lines) and gives it to the disk. What was flushed can be read, whatever
/// happens later. A part that does not fit on the disk leaves nothing of itself.
///
/// The file appears at once, unlike that of Writer, and another ContinuedWriter is kept out of it.
class ContinuedWriter {
 public:
  /// Begins a new file. Throws Error where the name is taken or cannot be made.
  /// @param comment  one line that opens the file, after `# `
  ContinuedWriter(const std::filesystem::path& path, const Columns& columns,
                  std::string_view comment);
  /// Goes on with a file: cuts off an unfinished part, and reads the rest once. Throws Error where
  /// it is no recording that can be read.
  explicit ContinuedWriter(const std::filesystem::path& path);
  ContinuedWriter(const ContinuedWriter&) = delete;
  ContinuedWriter& operator=(const ContinuedWriter&) = delete;

  [[nodiscard]] const Columns& columns() const { return columns_; }
  /// Content at the beginning of this session.
  [[nodiscard]] const HeldRecording& held() const { return held_; }

  /// Keeps a row for the next flush(). Row::findings is ignored.
  void write(const Row& row) { append_to_text(row); }
  /// Throws Error, as when the disk is full; the file is whole then, without the rows of this part.
  void flush();

 private:
  void append_to_text(const Row& row);
  void open(output::AppendedFile::Begin begin);
  [[nodiscard]] std::string packed() const;
  void cut_off_torn_part();
  void read_held();
  [[nodiscard]] Error cannot(std::string_view action, const std::error_code& fault) const;

  std::filesystem::path path_;
  bool is_packed_;
  Columns columns_;
  HeldRecording held_;
  std::optional<output::AppendedFile> file_;
  std::string text_;  ///< rows of the part that has not been flushed
};

}  // namespace zerorate::recording
