/// @file
/// Output of a program: nothing in it steers a terminal, and nothing is lost without a message.
#pragma once

#include <string>
#include <string_view>

namespace zerorate::hal::linux_os {

/// Text for a terminal or a journal that somebody else wrote, such as the name of a file: bytes
/// that would steer the terminal stand there as `\xNN`. Line ends and tabs stay.
[[nodiscard]] std::string printable(std::string_view text);

/// Writes out what is still buffered. For the end of a program: text that was lost since its start,
/// as on a full disk, is a std::system_error with the reason.
void flush_standard_output();

}  // namespace zerorate::hal::linux_os
