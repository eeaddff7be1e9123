/// @file
/// Effects in motion that a blind hour of drives hides, inside and outside the catalogue.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "host_tools/lab/campaign/drive_hour.hpp"
#include "host_tools/lib/simulate/sizing/sized_effect.hpp"

namespace zerorate::campaign {

/// An effect whose size is given by information. It acts on what is made, or on what was made.
struct SizedDriveEffect {
  std::string_view name;
  std::string_view figure;  ///< parameter in the answer; empty: none
  double unit = 1.0;        ///< size of which the figure is 1
  double first = 0.0;       ///< size from which the search starts
  double power = 1.0;       ///< power of the size in which the error grows
  std::function<void(HourOptions&, double size)> make;
  std::function<void(Hour&, double size)> change;
};

/// A fault of the reference or of rows with a size at random.
struct DriveFault {
  std::string_view name;
  /// Puts the fault into an hour. @return its kind and size in words
  std::function<std::string(Hour&, sizing::Draws&)> hide;
};

[[nodiscard]] std::span<const SizedDriveEffect> drive_effects();
[[nodiscard]] std::span<const SizedDriveEffect> drive_effects_outside();
[[nodiscard]] std::span<const DriveFault> drive_faults();

}  // namespace zerorate::campaign
