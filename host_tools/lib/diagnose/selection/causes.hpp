/// @file
/// The chosen effects as causes with words and drawings.
#pragma once

#include <vector>

#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"
#include "host_tools/lib/diagnose/selection/selection.hpp"

namespace zerorate::diagnose {

struct DescribedCauses {
  std::vector<Cause> causes;      ///< causes by rank
  std::vector<Drawing> drawings;  ///< in the order of the choices, one a cause
};

/// Describes each choice once.
/// @param hypothesis  with one part for each choice, in their order
[[nodiscard]] DescribedCauses describe_causes(const std::vector<Choice>& choices,
                                              const Hypothesis& hypothesis);

}  // namespace zerorate::diagnose
