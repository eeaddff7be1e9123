#include "hal/linux/standard_output.hpp"

#include <cerrno>
#include <cstdio>
#include <system_error>

namespace zerorate::hal::linux_os {
namespace {

/// A control character of ASCII.
bool is_c0(unsigned char byte) {
  return (byte < 0x20 && byte != '\n' && byte != '\t') || byte == 0x7F;
}

/// A control character of Latin 1, of which UTF-8 makes two bytes.
bool is_c1(unsigned char before, unsigned char byte) {
  return before == 0xC2 && byte >= 0x80 && byte < 0xA0;
}

}  // namespace

std::string printable(std::string_view text) {
  static constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string printed;
  unsigned char before = 0;
  for (const char character : text) {
    const auto byte = static_cast<unsigned char>(character);
    if (is_c1(before, byte)) printed.pop_back();
    if (is_c0(byte) || is_c1(before, byte)) {
      printed.append("\\x").append({kDigits[byte / 16U], kDigits[byte % 16U]});
    } else {
      printed += character;
    }
    before = byte;
  }
  return printed;
}

void flush_standard_output() {
  errno = 0;
  const bool is_lost = std::fflush(stdout) != 0 || std::ferror(stdout) != 0;
  if (!is_lost) return;
  throw std::system_error(errno != 0 ? errno : EIO, std::generic_category(),
                          "cannot write to the standard output");
}

}  // namespace zerorate::hal::linux_os
