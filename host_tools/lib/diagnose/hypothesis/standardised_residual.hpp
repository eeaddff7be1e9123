/// @file
/// The residual of a hypothesis as independent standard normal values.
#pragma once

#include <vector>

#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"

namespace zerorate::diagnose {

/// Residual of a record under a hypothesis, which must outlive it.
struct StandardisedResidual {
  explicit StandardisedResidual(const Hypothesis& of);

  const Hypothesis* hypothesis;
  std::vector<double> values;  ///< whitened and divided by the relative sigma: independent, N(0, 1)
};

}  // namespace zerorate::diagnose
