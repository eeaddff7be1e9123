/// @file
/// The fit of a noise spectrum to the DCT-II of a record (docs/design/diagnosis.md, section 2).
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/noise_parameters.hpp"
#include "host_tools/lib/diagnose/hypothesis/noise_spectrum.hpp"

namespace zerorate::diagnose {

/// Coefficients that stand alone, with their exact ratio to the nominal density.
inline constexpr std::size_t kSingleBins = 48;

/// Neighbouring DCT coefficients of nearly the same density.
struct SpectralBin {
  double sine;  ///< 2 sin(w/2) at the centre
  double mean_square;
  double count;
  std::size_t index;  ///< index of the coefficient where it stands alone, else 0
};

/// One bin for each of the first coefficients, 3 % wide ones above; towards the last coefficient,
/// where a low-pass may end in nothing, they are no wider than a tenth of what is left up to it,
/// and no wider than a tenth of the distance to a line.
/// @param coefficients c_0 .. c_{n-1}; c_0 is left out
/// @param line  index of the coefficient where a line stands; 0: none
[[nodiscard]] std::vector<SpectralBin> bin_coefficients(std::span<const double> coefficients,
                                                        std::size_t line = 0);

/// Brings bins up to date with coefficients of which those below `end` have changed.
void update_bins(std::span<SpectralBin> bins, std::span<const double> coefficients,
                 std::size_t end);

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

/// The most likely of some spectra, as the start of a fit. One evaluation each.
/// @param spectra  one or more
[[nodiscard]] NoiseSpectrum likeliest_of(std::span<const NoiseSpectrum> spectra,
                                         std::span<const SpectralBin> bins, std::size_t size);

/// A start for white and flicker noise alone.
[[nodiscard]] NoiseSpectrum rough_spectrum(std::span<const SpectralBin> bins);

}  // namespace zerorate::diagnose
