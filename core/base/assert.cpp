#include "core/base/assert.hpp"

namespace zerorate::core {

[[gnu::weak]] void assertion_failed(const char* /*file*/, int /*line*/) noexcept {
  __builtin_trap();
}

}  // namespace zerorate::core
