/// @file
/// toml++, to be included instead of its own header: its parser is compiled once, in parser.cpp.
#pragma once

namespace zerorate::toml_file {
/// Thrown by the parser where the text breaks an assumption that toml++ makes without checking it.
struct BrokenAssumption {};
}  // namespace zerorate::toml_file

#define TOML_HEADER_ONLY 0
#include <toml++/toml.h>
