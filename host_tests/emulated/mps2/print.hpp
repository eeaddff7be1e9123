/// @file
/// Lines of numbers, by the emulator's own output.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#ifdef __arm__
#include "hal/mps2/semihosting.hpp"
#else
#include <cstdio>
#endif

namespace zerorate::emulated {

inline void write(const char* text) {
#ifdef __arm__
  hal::mps2::Semihosting::write(text);
#else
  std::fputs(text, stdout);
#endif
}

/// "name number", in decimal.
inline void write_line(const char* name, std::uint32_t number) {
  std::array<char, 12> digits{};
  std::size_t first = digits.size() - 1;
  do {
    digits[--first] = static_cast<char>('0' + number % 10);
    number /= 10;
  } while (number > 0);
  write(name);
  write(" ");
  write(&digits[first]);
  write("\n");
}

}  // namespace zerorate::emulated
