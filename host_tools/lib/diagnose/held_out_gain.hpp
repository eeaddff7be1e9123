/// @file
/// The gain of the chosen effects, refitted to the first part of a record and judged on the rest.
#pragma once

#include <optional>
#include <vector>

#include "host_tools/lib/diagnose/diagnose.hpp"
#include "host_tools/lib/diagnose/selection/common_order.hpp"
#include "host_tools/lib/diagnose/selection/selection.hpp"

namespace zerorate::diagnose {

/// Fits the effects that the whole record needed to its first part and judges them on the rest.
/// Throws ModelCannotRun.
/// @param wanted  choices of the whole record
/// @param others  profile of the other axes where an order is in common
[[nodiscard]] Gain held_out_gain(const Record& record, const std::vector<Choice>& wanted,
                                 const std::optional<OrderProfile>& others,
                                 const DiagnoseOptions& options);

}  // namespace zerorate::diagnose
