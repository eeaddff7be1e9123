/// @file
/// Figures that effects need to add themselves to the node's model.
#pragma once

#include "host_tools/lib/diagnose/hypothesis/fit_data.hpp"

namespace zerorate::diagnose {

/// Filter tick of the node when it runs a model of this record [s].
[[nodiscard]] double node_tick_s(const FitData& data);

/// Standard deviation of a transient's or a ramp's size at the next start, relative to its size.
inline constexpr double kShareOfNextStart = 0.3;

}  // namespace zerorate::diagnose
