/// @file
/// Parts of a request for a line that both versions of libgpiod need.
#pragma once

#include <fcntl.h>

#include <cerrno>
#include <charconv>
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
/// @return whether it could be set; errno says why not
[[nodiscard]] inline bool set_non_blocking(int descriptor) {
  const int flags = fcntl(descriptor, F_GETFL);
  return flags >= 0 && fcntl(descriptor, F_SETFL, flags | O_NONBLOCK) >= 0;
}

}  // namespace zerorate::hal::linux_os
