/// @file
/// The bytes and lines of a file, unpacked if they are gzip, in constant memory.
#pragma once

#include <zlib.h>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/text_decoder.hpp"

namespace zerorate::recording {

/// Reads a file or standard input. gzip is known by its first two bytes, not by the file's name.
/// A gzip stream that ends early or fails its checksum is an error, never the end of the file;
/// this is why it does not use gzread, which hands a cut file out as a short one.
class ByteSource {
 public:
  /// "-" is standard input. Throws Error for what cannot be opened or is a directory.
  explicit ByteSource(const std::filesystem::path& path);
  ~ByteSource();
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  /// Writes at least one and at most out.size() bytes to the front of `out`.
  /// @param line  where the caller stands in the text, for the error message; 0 for nowhere
  /// @return how many; 0 at the end of the file. Throws Error.
  [[nodiscard]] std::size_t read(std::span<char> out, std::uint64_t line);

  /// How much of the file, as it lies on the disk, has been taken: 0 to 1; nullopt for pipes.
  [[nodiscard]] std::optional<double> fraction_read() const;

  /// The path as given, or "standard input".
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  struct Closer {
    void operator()(std::FILE* file) const;
  };

  bool refill(std::uint64_t line);
  void begin_inflating();
  std::size_t inflate_into(std::span<char> out, std::uint64_t line);
  std::size_t copy_into(std::span<char> out, std::uint64_t line);

  std::string name_;
  std::unique_ptr<std::FILE, Closer> file_;
  std::vector<unsigned char> input_;
  std::uint64_t size_ = 0;  ///< bytes on the disk; 0 for pipes
  std::uint64_t taken_ = 0;
  z_stream stream_{};  ///< its next_in and avail_in are the rest of input_, also for plain files
  bool inflating_ = false;
  bool between_members_ = false;  ///< a gzip file may be several streams one after the other
};

/// Splits a ByteSource into lines ended by LF, CR LF or, in a file without LF, by CR. UTF-16 with a
/// byte order mark becomes UTF-8, and a byte order mark of UTF-8 is skipped. No line may be longer
/// than 1 MiB, the size of the buffer.
class LineReader {
 public:
  explicit LineReader(const std::filesystem::path& path);

  /// The next line without its end, valid until the next call; false at the end of the file.
  /// Throws Error.
  [[nodiscard]] bool next(std::string_view& line);

  /// Text behind the line last given, up to 64 KiB of it: line ends are LF or CR LF. Throws Error.
  [[nodiscard]] std::string_view ahead();

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
  [[nodiscard]] std::size_t read(std::span<char> out);

  ByteSource source_;
  std::optional<TextDecoder> decoder_;  ///< begun with the first bytes
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  ///< buffer_[begin_, end_) is read but not yet given out
  std::size_t end_ = 0;
  std::uint64_t line_ = 0;
  bool is_terminated_ = true;
};

}  // namespace zerorate::recording
