/// @file
/// Text results of a command, into a file or to the standard output, and the progress of long work.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace zerorate::cli {

/// Writes the text into the file; "-" is the standard output. Throws std::system_error.
void write_text(const std::filesystem::path& path, const std::string& text);

/// The words of a paragraph in lines of at most 100 characters.
[[nodiscard]] std::string wrapped(std::string_view paragraph);

/// Rows of cells under each other, the columns as wide as they need to be.
/// @param rows  of equal size
[[nodiscard]] std::string aligned(const std::vector<std::vector<std::string>>& rows);

/// A line on the error stream that is redrawn at most ten times a second and wiped at the end.
/// Draws nothing if the error stream is no terminal.
class ProgressBar {
 public:
  explicit ProgressBar(std::string what);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// @param share of the work that is done, 0 to 1; nullopt where the whole is not known
  /// @param remark such as a rate, drawn after the share
  void update(std::optional<double> share, const std::string& remark = {});

 private:
  using Clock = std::chrono::steady_clock;

  std::string what_;
  bool visible_;
  bool drawn_ = false;
  Clock::time_point started_ = Clock::now();
  Clock::time_point drawn_at_{};
};

/// A number for a table; "-" where nothing was measured.
[[nodiscard]] std::string cell(double value, int decimals);

}  // namespace zerorate::cli
