/// @file
/// What a hypothesis leaves of a record, as independent standard normal values.
#pragma once

#include <vector>

#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"

namespace zerorate::diagnose {

/// What is left of a record under a hypothesis.
struct Remainder {
  explicit Remainder(const Explanation& explanation);

  const Explanation* explanation;
  std::vector<double> values;  ///< whitened and divided by the relative sigma: independent, N(0, 1)
};

}  // namespace zerorate::diagnose
