/// @file
/// What the keys of a file must satisfy.
#pragma once

#include <cstdint>
#include <string_view>

namespace zerorate::toml_file {

enum class Presence : std::uint8_t { required, optional };

/// What a number must satisfy, in code and in words ("a positive number").
struct Rule {
  bool (*holds)(double);
  std::string_view words;
};

}  // namespace zerorate::toml_file
