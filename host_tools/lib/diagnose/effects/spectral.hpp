/// @file
/// What effects that change the spectrum of the noise have in common.
#pragma once

#include <cmath>
#include <optional>
#include <utility>

#include "host_tools/lib/diagnose/effects/effect.hpp"

namespace zerorate::diagnose {

/// Adds the part to the hypothesis; its gain, without the surprise.
[[nodiscard]] Offer offer_with(const Explanation& without, Part part);

/// The same where the part has to be placed: its starts become the noise that was found, so that
/// later fits need not search again.
[[nodiscard]] Offer placed_offer_with(const Explanation& without, Part part);

/// A positive figure, half of whose logarithm's standard error is given twice: value e^(+-1.96 se).
[[nodiscard]] Parameter positive_parameter(std::string name, double value, double log_error);

/// A figure with a symmetric interval.
[[nodiscard]] Parameter parameter(std::string name, double value, double standard_error);

/// What the node averages over when it runs the model of this record.
[[nodiscard]] double node_tick_s(const Problem& problem);

/// How much an effect of this start may differ at the next one.
inline constexpr double kShareOfNextStart = 0.3;

inline constexpr double kDegPerRad = 57.295779513082320876798;

}  // namespace zerorate::diagnose
