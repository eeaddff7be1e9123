/// @file
/// The hook for programmer errors. Hardware faults and user input never end here: they are Results.
#pragma once

namespace zerorate::core {

/// Called when a ZERORATE_ASSERT fails; must not return. The default (assert.cpp) traps; an
/// application replaces it by defining a function of the same name in its own code.
[[noreturn]] void assertion_failed(const char* file, int line) noexcept;

}  // namespace zerorate::core

/// Checks a contract between two pieces of our own code, in every build.
#define ZERORATE_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : ::zerorate::core::assertion_failed(__FILE__, __LINE__))
