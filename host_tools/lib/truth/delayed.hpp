/// @file
/// A reference whose heading is late.
#pragma once

#include <cstdint>

#include "host_tools/lib/truth/track.hpp"
#include "host_tools/lib/truth/truth.hpp"

namespace zerorate::truth {

/// The same stops, with the turns that a heading gives when its delay is taken off. The error of
/// the reference at its stops is estimated again, unless it was given.
/// @param delay_ns of the headings; negative: they are ahead
[[nodiscard]] Truth without_delay(Truth truth, const Track& track, std::int64_t delay_ns);

}  // namespace zerorate::truth
