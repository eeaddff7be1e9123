/// @file
/// A mean function that is searched for and fitted beside a hypothesis.
#pragma once

#include <functional>
#include <optional>

#include "host_tools/lib/diagnose/hypothesis/column_search.hpp"

namespace zerorate::diagnose {

/// A search that names the best part at the given noise.
using MeanSearch = std::function<std::optional<Part>(const ColumnSearch&)>;

/// A part that was found, and the hypothesis that it makes.
struct MeanFit {
  Part part;
  double gain_nats = 0.0;
  Hypothesis with;  ///< the part, which is the last one
};

/// Searches, fits the noise again and searches once more at the new noise; the better of the two
/// parts. Nothing where the search finds nothing. Two fits.
[[nodiscard]] std::optional<MeanFit> fit_mean(const Hypothesis& without, const MeanSearch& search);

}  // namespace zerorate::diagnose
