/// @file
/// Part of a hypothesis that one effect contributes.
#pragma once

#include <cstddef>
#include <limits>
#include <string_view>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/noise_spectrum.hpp"

namespace zerorate::diagnose {

/// A function of time as DCT coefficients; the coefficients outside are zero.
struct Column {
  std::size_t first = 1;
  std::vector<double> coefficients;

  [[nodiscard]] std::size_t end() const { return first + coefficients.size(); }
};

/// Neighbouring values [first, end).
struct Run {
  std::size_t first = 0;
  std::size_t end = 0;
};

/// The measuring range, about the median of the record [rad/s].
struct Range {
  double lo = -std::numeric_limits<double>::infinity();
  double hi = std::numeric_limits<double>::infinity();

  bool operator==(const Range&) const = default;
};

/// Contribution of an effect to a hypothesis. Most effects use one or two of the members.
struct Part {
  std::string_view effect;
  NoiseTerms terms;
  std::vector<NoiseSpectrum> starts;  ///< starts for the fit of the terms
  std::vector<Column> columns;        ///< mean functions, whose amplitudes are fitted
  std::vector<double> shape;  ///< further figures of the effect; each effect documents its own
  double log_p_of_even_times = 0.0;  ///< log P that its events come as evenly by chance; 0: unknown
  std::vector<Run> replaced;         ///< values without information on the noise
  Range clipped;                     ///< replaced values at its ends are known to lie beyond them
  std::vector<float> relative_sigma;  ///< sigma of the white noise, one a value; empty: 1
};

}  // namespace zerorate::diagnose
