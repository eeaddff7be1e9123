/// @file
/// DCT coefficients gathered in bins of nearly the same density, so that a fit does not depend on
/// the length of the record.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace zerorate::diagnose {

/// Coefficients that stand alone, with their exact ratio to the nominal density.
inline constexpr std::size_t kSingleBins = 48;

/// Neighbouring DCT coefficients of nearly the same density.
struct SpectralBin {
  double sine;  ///< 2 sin(w/2) at the centre
  double mean_square;
  double count;
  std::size_t index;  ///< of the coefficient where it stands alone, else 0
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

}  // namespace zerorate::diagnose
