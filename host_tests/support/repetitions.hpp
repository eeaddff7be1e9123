/// @file
/// How often a statistical test repeats what it does.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>

namespace zerorate::testing {

/// The usual number, or that of $ZERORATE_REPETITIONS: `./test --slow` asks for more.
inline std::uint64_t repetitions(std::uint64_t usual) {
  const char* const asked = std::getenv("ZERORATE_REPETITIONS");
  return asked == nullptr ? usual : std::stoull(asked);
}

/// The usual first seed, or that of $ZERORATE_FIRST_SEED: seeds that nobody looked at.
inline std::uint64_t first_seed(std::uint64_t usual) {
  const char* const asked = std::getenv("ZERORATE_FIRST_SEED");
  return asked == nullptr ? usual : std::stoull(asked);
}

}  // namespace zerorate::testing
