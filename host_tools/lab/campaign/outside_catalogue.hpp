/// @file
/// Effects that the diagnosis has no name for.
#pragma once

#include <span>

#include "host_tools/lib/simulate/sizing/sized_effect.hpp"

namespace zerorate::campaign {

/// Each effect costs the best model of the diagnosis the nats that are asked for: its size counts
/// what is left when the nearest effects of the catalogue have taken their share.
[[nodiscard]] std::span<const sizing::EffectEntry> outside_catalogue();

}  // namespace zerorate::campaign
