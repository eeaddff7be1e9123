/// @file
/// Curves of simulations of a hypothesis, beside those of the record (docs/design/diagnosis.md,
/// section 7).
#pragma once

#include <vector>

#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

/// Curves of a record over those of both hypotheses.
struct Envelopes {
  std::vector<CurvePoint> allan;    ///< rad/s
  std::vector<CurvePoint> density;  ///< one-sided, (rad/s)^2/Hz
  std::vector<Misfit> misfit;       ///< against the base
};

/// Simulates both hypotheses 16 to 64 times, fewer for longer records: coefficients of the DCT are
/// drawn with the fitted density, mean functions are added, the transform brings them back.
[[nodiscard]] Envelopes simulate_envelopes(const Hypothesis& base, const Hypothesis& extended);

}  // namespace zerorate::diagnose
