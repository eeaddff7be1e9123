/// @file
/// The files that commands write.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <string_view>

namespace zerorate::output {

/// A file that appears under its name only when it is complete.
///
/// A regular file is written under a temporary name beside it (`NAME.<random>.partial`) and renamed
/// by finish(); it keeps the permissions of the file that it replaces. The target of a symbolic
/// link is replaced, not the link. Whatever else has the name already, such as a device or a FIFO,
/// is written to in place, as a shell's redirection does.
///
/// All members throw std::system_error with the name of the file.
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  /// Removes the temporary file unless finish() has succeeded.
  ~OutputFile();

  /// Appends the text. Unbuffered: one call of the kernel.
  void write(std::string_view text);
  /// Closes the file and gives it its name. No write() may follow.
  void finish();

  /// For a library that writes to descriptors itself; stays owned by this object.
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  void open_partial();
  void close_descriptor();
  void forget_partial();
  [[noreturn]] void fail() const;

  std::filesystem::path path_;
  std::string partial_;  ///< empty where the file is written in place
  std::atomic<const char*>* registered_ = nullptr;
  int descriptor_ = -1;
};

/// Gives a file that was written another name, so that after a power cut the name has the old
/// content or all of the new one: the content is on the disk before the name is, and both are at
/// the end. Throws std::system_error.
void replace_file(const std::filesystem::path& written, const std::filesystem::path& name);

/// Writes a whole text with OutputFile.
void write_file(const std::filesystem::path& path, std::string_view text);

/// From now on SIGHUP, SIGINT and SIGTERM remove the temporary files before they end the process.
/// Signals that are ignored, as nohup does with SIGHUP, stay ignored. For a program's main().
void remove_partial_files_on_signals();

}  // namespace zerorate::output
