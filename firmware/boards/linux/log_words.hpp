/// @file
/// Words of the log: lines in fixed buffers, faults with place, reason and cure.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "firmware/boards/linux/configuration.hpp"
#include "firmware/boards/linux/process/log.hpp"

namespace zerorate::linux_node {

using LogBuffer = std::array<char, 512>;

/// Text in a fixed buffer; what does not fit is cut off.
class Line {
 public:
  explicit Line(LogBuffer& buffer) : buffer_(buffer) {}

  template <class... Arguments>
  void add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    const auto added = fmt::format_to_n(buffer_.data() + used_, buffer_.size() - used_, format,
                                        std::forward<Arguments>(arguments)...);
    used_ = std::min(used_ + added.size, buffer_.size());
  }
  [[nodiscard]] std::string_view text() const { return {buffer_.data(), used_}; }

 private:
  LogBuffer& buffer_;
  std::size_t used_ = 0;
};

/// A line for the log, without a heap.
template <class... Arguments>
void log_line(const Log& log, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  LogBuffer buffer{};
  Line line(buffer);
  line.add(format, std::forward<Arguments>(arguments)...);
  log(line.text());
}

/// Cures of faults by the kernel's error number, to be added to a line; empty where none is known.
[[nodiscard]] std::string_view cure_of_line(int error_number);
[[nodiscard]] std::string_view cure_of_speed(int error_number);
[[nodiscard]] std::string_view cure_of_sink(std::string_view sink, int error_number);

/// An error of the gyro for the log, with place, reason and cure: "/dev/i2c-1: Permission denied
/// (is the user in the device's group, i2c or spi?)".
[[nodiscard]] std::string_view describe(const GyroSettings& gyro, const drivers::DriverError& error,
                                        const GyroReason& reason, LogBuffer& buffer);

/// "odometer /dev/gpiochip0 line 24"
[[nodiscard]] std::string name_of_odometer(const Configuration& configuration);

/// The node as it was configured, in one line for the log.
[[nodiscard]] std::string describe(const Configuration& configuration);

}  // namespace zerorate::linux_node
