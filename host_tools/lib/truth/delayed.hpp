/// @file
/// A reference whose heading is late.
#pragma once

#include <cstdint>

#include "host_tools/lib/truth/track.hpp"
#include "host_tools/lib/truth/truth.hpp"

namespace zerorate::truth {

/// Takes a delay off the headings of a truth. The stops stay; turns and flaws of the drives are
/// found again, and so is the error of the reference at its stops, unless it was given.
/// @param delay_ns of the headings; negative: they are ahead
[[nodiscard]] Truth without_delay(Truth truth, const Track& track, std::int64_t delay_ns);

}  // namespace zerorate::truth
