/// @file
/// Refusal of parameters that nothing real can have.
#pragma once

#include <stdexcept>

namespace zerorate::simulate {

/// Throws std::invalid_argument that says what was expected.
inline void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(what);
}

}  // namespace zerorate::simulate
