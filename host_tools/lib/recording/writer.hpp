/// @file
/// The writer of recordings.
#pragma once

#include <zlib.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

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

}  // namespace zerorate::recording
