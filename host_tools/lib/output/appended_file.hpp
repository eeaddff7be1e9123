/// @file
/// A file that grows by whole parts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace zerorate::output {

/// A regular file that one process at a time appends to. A part that does not fit on the disk
/// leaves nothing of itself.
///
/// All members but size() and descriptor() throw std::system_error with the name of the file:
/// std::errc::file_exists where a new file's name is taken, std::errc::text_file_busy where another
/// process appends to the file, std::errc::invalid_seek where it is no regular file.
class AppendedFile {
 public:
  enum class Begin : bool { anew, at_the_end };

  /// Opens and locks the file; `anew` makes it.
  AppendedFile(const std::filesystem::path& path, Begin begin);
  AppendedFile(const AppendedFile&) = delete;
  AppendedFile& operator=(const AppendedFile&) = delete;
  ~AppendedFile();

  /// Appends a part and gives it to the disk.
  void append(std::string_view part);
  /// Keeps the first bytes only.
  void cut_to(std::uint64_t bytes);

  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// For reading; stays owned by this object.
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  [[noreturn]] void fail(int reason) const;

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace zerorate::output
