/// @file
/// How often a statistical test repeats what it does, and from which seed on.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>

namespace zerorate::testing {

inline std::uint64_t asked_for(const char* variable, std::uint64_t usual) {
  const char* const asked = std::getenv(variable);
  return asked == nullptr ? usual : std::stoull(asked);
}

/// The usual number, or that of $ZERORATE_REPETITIONS: `./test --slow` asks for more.
inline std::uint64_t repetitions(std::uint64_t usual) {
  return asked_for("ZERORATE_REPETITIONS", usual);
}

/// The usual first seed, or that of $ZERORATE_FIRST_SEED: seeds that nobody looked at.
inline std::uint64_t first_seed(std::uint64_t usual) {
  return asked_for("ZERORATE_FIRST_SEED", usual);
}

}  // namespace zerorate::testing
