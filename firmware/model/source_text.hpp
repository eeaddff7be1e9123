/// @file
/// Pieces of source code that C and C++ share.
#pragma once

#include <array>
#include <charconv>
#include <cstdint>
#include <string>

#include "core/base/complex.hpp"
#include "core/base/time.hpp"

namespace zerorate::model {

/// The shortest decimal from which a compiler makes the same bits. The value must be finite.
[[nodiscard]] inline std::string literal(float value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  std::string text{digits.data(), end};
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text + "F";
}
[[nodiscard]] inline std::string literal(const core::Complex& value) {
  return "{" + literal(value.re) + ", " + literal(value.im) + "}";
}

/// For a comment: the rates that a model was exported for, in whole millihertz.
[[nodiscard]] inline std::string rates(core::Duration sample_period, core::Duration filter_tick) {
  const auto hertz = [](core::Duration period) {
    constexpr std::int64_t kMilliseconds = 1'000'000'000'000;
    const std::int64_t millihertz = (kMilliseconds + period.ns() / 2) / period.ns();
    std::string fraction = std::to_string(millihertz % 1000 + 1000).substr(1);
    return std::to_string(millihertz / 1000) + "." + fraction + " Hz";
  };
  return hertz(sample_period) + " samples and " + hertz(filter_tick) + " ticks of the filter";
}

/// For a comment: a name cannot end it and go on as source.
[[nodiscard]] inline std::string in_comment(std::string text) {
  for (char& character : text) {
    const bool is_control = static_cast<unsigned char>(character) < ' ';
    if (is_control || character == '\\' || character == '*') character = ' ';
  }
  return text;
}

}  // namespace zerorate::model
