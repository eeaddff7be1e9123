/// @file
/// Helpers of the effects that are mean functions of time or temperature.
#pragma once

#include <optional>

#include "host_tools/lib/diagnose/effects/effect.hpp"
#include "host_tools/lib/diagnose/hypothesis/column_search.hpp"
#include "host_tools/lib/diagnose/hypothesis/linear_model.hpp"

namespace zerorate::diagnose {

/// The offer of a fitted mean, without its surprise.
[[nodiscard]] std::optional<Candidate> mean_candidate(const Hypothesis& without,
                                                      const MeanSearch& search);

/// Standard error of a parameter that a column depends on, from the derivative of the mean by it.
[[nodiscard]] double shape_error(const FittedPart& fitted, const Column& derivative);

/// The mean function of a part over the data, thinned, with the level that the record has.
[[nodiscard]] Drawing drawing_of(const FittedPart& fitted);

}  // namespace zerorate::diagnose
