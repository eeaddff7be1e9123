/// @file
/// How far a long piece of work is; silent where nobody looks.
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace zerorate::cli {

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

}  // namespace zerorate::cli
