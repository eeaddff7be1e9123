/// @file
/// Candidates of effects that change the spectrum of the noise.
#pragma once

#include "host_tools/lib/diagnose/effects/effect.hpp"

namespace zerorate::diagnose {

/// Candidate of a part that is added to a hypothesis: its gain, without the surprisal. One fit.
[[nodiscard]] Candidate candidate_with(const Hypothesis& without, Part part);

/// Candidate of a part that has to be placed: the noise that was found becomes its only start, so
/// that later fits need not search again. One fit.
[[nodiscard]] Candidate placed_candidate(const Hypothesis& without, Part part);

}  // namespace zerorate::diagnose
