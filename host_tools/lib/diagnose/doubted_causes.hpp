/// @file
/// Reasons why slow causes that fit a record are not proven.
#pragma once

#include <string_view>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"
#include "host_tools/lib/diagnose/selection/selection.hpp"

namespace zerorate::diagnose {

/// Explanation beside the effects of the catalogue: software between the sensor and the recording.
inline constexpr std::string_view kByBiasTakenOut = "bias_taken_out";

/// Three causes that were searched for in time or in slow noise draw any record. A record is far
/// more often one that nothing in the catalogue fits than one with three rare effects at once, so
/// that their fit proves none of them. A cause that was measured beside the rate does not count.
void doubt_many_slow_causes(const std::vector<Choice>& choices, const Hypothesis& hypothesis,
                            Adequacy& adequacy);

/// Software that takes a bias out of the rates shapes their slow noise, and no record shows by how
/// much: each slow cause that was not measured beside the rate has it as an explanation of equal
/// probability, and something is left unexplained.
void doubt_causes_after_correction(std::vector<Choice>& choices, const Hypothesis& hypothesis,
                                   Adequacy& adequacy);

}  // namespace zerorate::diagnose
