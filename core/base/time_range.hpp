/// @file
/// Which times can be reckoned with.
#pragma once

#include <cstdint>

#include "core/base/time.hpp"

namespace zerorate::core {

/// From 73 years before the clock's zero to 146 years after it: the difference of two such times,
/// and that difference and any period of a sensor, fits into 64 bits of nanoseconds. What comes
/// from outside is refused beyond it.
inline constexpr Instant kEarliestTime = Instant::from_ns(-(std::int64_t{1} << 61));
inline constexpr Instant kLatestTime = Instant::from_ns(std::int64_t{1} << 62);

[[nodiscard]] constexpr bool is_in_range(Instant time) {
  return kEarliestTime.ns() <= time.ns() && time.ns() <= kLatestTime.ns();
}

}  // namespace zerorate::core
