/// @file
/// Scale factor error of an axis, from full turns between marks.
#pragma once

#include <optional>
#include <span>

#include "host_tools/lib/statistics/half_width.hpp"

namespace zerorate::calibrate {

/// Full turns about one axis, from a mark to the same mark.
struct CountedTurn {
  double measured_rad = 0.0;
  /// Standard deviation of `measured_rad` by bias and noise, without the scale factor.
  double sigma_rad = 0.0;
  int turns = 0;  ///< true number, negative in the other sense; not zero
};

/// A figure relative to the rate, 0.01 is 1 %, with its standard deviation.
struct RelativeError {
  double value = 0.0;
  double sigma = 0.0;

  /// Half the width of the 95 % interval.
  [[nodiscard]] double half_width() const { return statistics::kHalfWidth95 * sigma; }
};

struct ScaleFit {
  RelativeError scale;
  /// Half the difference between the scale factors of both senses; only where both were turned.
  std::optional<RelativeError> asymmetry;
};

/// Knowledge of a calibration that its turns do not show.
struct FitSettings {
  double mark_sigma_rad = 0.0;   ///< error of a stop at the mark, standard deviation
  double asymmetry_sigma = 0.0;  ///< tolerance of the asymmetry; counts where it is not measured
};

/// Fits measured - true = scale * true + asymmetry * |true| by weighted least squares.
///
/// Each stop at the mark is the end of one turn and the beginning of the next, so that its error
/// enters both with opposite signs. The weights neglect this correlation. The covariance of the
/// result contains it.
/// @param turns in their order, at least one
[[nodiscard]] ScaleFit fit_scale(std::span<const CountedTurn> turns, const FitSettings& settings);

}  // namespace zerorate::calibrate
