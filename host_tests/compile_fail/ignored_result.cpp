#pragma GCC diagnostic error "-Wunused-result"
#include "core/base/result.hpp"

enum class Refusal : unsigned char { late };
zerorate::core::Result<void, Refusal> act();

void call() {
#ifdef MUST_NOT_COMPILE
  act();
#else
  static_cast<void>(act());
#endif
}
