/// @file
/// The fit of a noise spectrum to the DCT-II of a record (docs/design/diagnosis.md, section 2).
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "host_tools/lib/diagnose/hypothesis/noise_parameters.hpp"
#include "host_tools/lib/diagnose/hypothesis/noise_spectrum.hpp"
#include "host_tools/lib/diagnose/hypothesis/spectral_bins.hpp"

namespace zerorate::diagnose {

struct SpectrumFit {
  NoiseSpectrum spectrum;
  double log_likelihood = 0.0;  ///< -1/2 sum log S_k + c_k^2 / S_k
  std::array<double, kNoiseParameters.size()> errors{};

  /// Standard error of a parameter on the scale that it is fitted on (see NoiseParameter), from the
  /// expected information; 0 where the parameter was not fitted.
  [[nodiscard]] double error(NoiseParameterId id) const {
    return errors[static_cast<std::size_t>(id)];
  }
};

/// Maximises the Whittle likelihood by Fisher scoring with analytic derivatives from each start;
/// the best one counts, with its kind of low-pass. Some 20 us an iteration.
/// @param size of the record
[[nodiscard]] SpectrumFit fit_spectrum(std::span<const SpectralBin> bins, std::size_t size,
                                       const NoiseTerms& terms,
                                       std::span<const NoiseSpectrum> starts);

/// A start for white and flicker noise alone.
[[nodiscard]] NoiseSpectrum rough_spectrum(std::span<const SpectralBin> bins);

}  // namespace zerorate::diagnose
