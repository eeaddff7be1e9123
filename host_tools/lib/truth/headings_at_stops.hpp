/// @file
/// References that measure the heading only where the vehicle stands: marks on the ground, two
/// antennas at rest, or the same parking place again and again.
#pragma once

#include <optional>
#include <vector>

#include "host_tools/lib/truth/track.hpp"
#include "host_tools/lib/truth/truth.hpp"

namespace zerorate::truth {

/// True where all headings were measured while the vehicle stood, and at two stops at least.
/// @param truth with its stops and the limit of their speed
[[nodiscard]] bool are_at_stops(const Track& track, const Truth& truth);

/// Leaves those stops at which a heading was measured.
void keep_stops_with_heading(const Series& heading_rad, std::vector<Stop>& stops);

/// The track without the bias in the gyro's turns: at a stop its own, between two stops the mean of
/// theirs. A bias of 0.5 deg/s would otherwise count a whole turn in twelve minutes.
/// @param stops each with a heading
[[nodiscard]] Track without_bias(const Track& track, const std::vector<Stop>& stops);

/// The axis with the largest turns from heading to heading. It has the sense in which the headings
/// fit better, and that of the axis where both fit.
/// @param track without bias
/// @return nullopt if no axis turns by more than kLeastTurns_rad
[[nodiscard]] std::optional<VerticalAxis> axis_of_net_turns(const Track& track);

}  // namespace zerorate::truth
