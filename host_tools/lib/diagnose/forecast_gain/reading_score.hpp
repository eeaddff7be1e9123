/// @file
/// Log density of a single reading under a forecast.
#pragma once

#include "core/samples/sample_model.hpp"
#include "core/samples/sample_screen.hpp"

namespace zerorate::diagnose {

/// Scale that readings are read off; by default a reading is the rate itself.
struct Scale {
  double step_rad_s = 0.0;  ///< step that readings are rounded to; 0: none
  /// Spacing of the levels that readings lie on, where the model does not know of them: its density
  /// at the levels is made to sum to 1. 0: there are none.
  double unknown_step_rad_s = 0.0;
  double rounding_variance = 0.0;  ///< share of it in the variance of a forecast
  /// Width of the cell that a reading at the end of the range stands for, where nothing is rounded.
  double end_cell_rad_s = 0.0;
  core::MeasuringRange range;
};

/// Log density of a reading, or the log of its probability over the width of its cell: rounded, it
/// stands for half a step on both sides, at an end of the range for all beyond. So densities and
/// probabilities can be compared, and each sums to 1 over all readings (Dawid 1984: prequential).
/// The mean of the readings is expected, because the filter learns it.
[[nodiscard]] double log_score(const core::SampleScreen::Forecast& forecast, double reading_rad_s,
                               const Scale& scale);

}  // namespace zerorate::diagnose
