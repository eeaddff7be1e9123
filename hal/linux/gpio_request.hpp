/// @file
/// Parts of a request for a line that both versions of libgpiod need, and the count of the events
/// that a version with numbered events has lost.
#pragma once

#include <fcntl.h>

#include <cerrno>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>
#include <system_error>

#include "core/base/result.hpp"
#include "hal/linux/bus_error.hpp"

namespace zerorate::hal::linux_os {

/// Meaning of errno after a call on a GPIO chip.
[[nodiscard]] inline core::Unexpected<BusError> last_line_error() {
  return core::Unexpected{to_bus_error(errno, Subsystem::gpio)};
}

/// The number of a line that is given by number; none where it is given by name.
[[nodiscard]] inline std::optional<unsigned> line_number(std::string_view line) {
  unsigned number = 0;
  const char* const end = line.data() + line.size();
  const auto [stop, error] = std::from_chars(line.data(), end, number);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return number;
}

/// Reading gives EAGAIN then, where there is nothing to read.
/// @return whether it could be set; errno has the reason
[[nodiscard]] inline bool set_non_blocking(int descriptor) {
  const int flags = fcntl(descriptor, F_GETFL);
  return flags >= 0 && fcntl(descriptor, F_SETFL, flags | O_NONBLOCK) >= 0;
}

/// The kernel numbers the events of a line request from 1 on, in 32 bits that wrap. Nothing is lost
/// as long as each number follows the one before it.
class SequenceGaps {
 public:
  /// How many events are missing between the one before and this one.
  std::uint32_t take(std::uint32_t number) {
    const std::uint32_t missing = number - newest_ - 1U;
    newest_ = number;
    return missing;
  }

 private:
  std::uint32_t newest_ = 0;
};

}  // namespace zerorate::hal::linux_os
