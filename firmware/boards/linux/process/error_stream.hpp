/// @file
/// Lines on the error stream, which the journal, a file or a pipe takes, or nobody.
#pragma once

#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "hal/linux/clock.hpp"

namespace zerorate::linux_node {

/// Writes lines without ever waiting and without ever failing: a line for which there is no room is
/// dropped and counted, and the count is told with the next line that is taken. The same line comes
/// once a minute at most, with the number of times that it was left out. One thread.
class ErrorStream {
 public:
  explicit ErrorStream(int descriptor = STDERR_FILENO) : descriptor_(descriptor) {}

  /// @param line  without a newline at its end; what is beyond 4000 bytes is cut off
  void write_line(std::string_view line, core::Instant now = hal::linux_os::KernelClock::now());
  /// Lines that nobody took.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  struct Recent {
    std::string line;
    core::Instant at;
    std::uint32_t left_out = 0;
  };
  static constexpr core::Duration kOncePer = core::Duration::seconds(60);

  /// Line among the newest ones; nullptr where it is none of them.
  Recent* find(std::string_view line);
  void remember(std::string_view line, core::Instant now);
  bool write(std::string text) const;

  int descriptor_;
  std::uint64_t lost_ = 0;
  std::uint64_t lost_untold_ = 0;
  std::array<Recent, 8> recent_{};
  std::size_t next_ = 0;  ///< place that is forgotten next
};

/// Opens what stands for the standard streams where they are closed, so that no other file gets
/// their numbers and the lines.
void keep_standard_descriptors();

}  // namespace zerorate::linux_node
