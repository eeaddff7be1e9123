/// @file
/// The lines of a text file, in place and in constant memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "host_tools/lib/recording/byte_source.hpp"
#include "host_tools/lib/recording/error.hpp"

namespace zerorate::recording {

/// Splits a ByteSource into lines ended by LF or CR LF. A UTF-8 byte order mark is skipped.
/// No line may be longer than 1 MiB, the size of the buffer.
class LineReader {
 public:
  explicit LineReader(const std::filesystem::path& path);

  /// The next line without its end, valid until the next call; false at the end of the file.
  /// Throws Error.
  [[nodiscard]] bool next(std::string_view& line);

  /// Number of the line last given, from 1; 0 before the first.
  [[nodiscard]] std::uint64_t line() const { return line_; }
  /// False if the line last given was the last of the file and had no line end.
  [[nodiscard]] bool is_terminated() const { return is_terminated_; }
  /// The line last given, at a character counted from 1 (0: the line as a whole).
  [[nodiscard]] Place place(std::uint64_t column = 0) const;
  [[nodiscard]] std::optional<double> fraction_read() const { return source_.fraction_read(); }

 private:
  [[nodiscard]] bool fill();
  std::string_view take(std::size_t length, std::size_t end_length);

  ByteSource source_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  ///< buffer_[begin_, end_) is read but not yet given out
  std::size_t end_ = 0;
  std::uint64_t line_ = 0;
  bool is_terminated_ = true;
};

}  // namespace zerorate::recording
