/// @file
/// Rules for the keys of a file.
#pragma once

#include <cstdint>
#include <string_view>

namespace zerorate::toml_file {

enum class Presence : std::uint8_t { required, optional };

/// Rule for a number, in code and in words ("a positive number").
struct Rule {
  bool (*holds)(double);
  std::string_view words;
};

}  // namespace zerorate::toml_file
