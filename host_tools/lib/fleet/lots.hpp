/// @file
/// Lots of a population: those that agree, and those that differ from them, with sizes.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "host_tools/lib/fleet/population.hpp"

namespace zerorate::fleet {

/// Lots of fewer sensors are not compared.
inline constexpr std::size_t kFewestSensorsOfLot = 4;

/// Lots that the others are compared with: the quietest group of lots that agree within chance and
/// are half of the lots at least. Where no half agrees, the half that differs least, with a
/// warning.
///
/// The quietest, because of two groups of the same size only the noise shows which is the bad
/// one. Up to half of the lots may be bad. Sets Lot::is_reference.
void choose_reference_lots(Population& population);

/// Compares each lot with the other lots of the reference, figure by figure: rank sums (Mann and
/// Whitney 1947) of the sensors' noise, and the share of outliers (Fisher's exact test). The least
/// p-value of a lot, times the number of its figures, is that of the lot. Sets the lots and their
/// figures, without effects.
void compare_lots(Population& population);

/// Likelihood of a member, or nullptr where it was not kept.
using KeptLikelihood = std::function<const AxisLikelihood*(std::size_t member)>;

/// Sets the effects of the figures: differences of the likeliest means, whose errors are those of
/// independent sensors. Sensors with rare effects do not count.
void measure_lot_effects(Population& population, const KeptLikelihood& likelihood);

}  // namespace zerorate::fleet
