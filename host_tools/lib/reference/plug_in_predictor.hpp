/// @file
/// The paper's full-state filter for a whole batch of calibrations of one length.
#pragma once

#include <cstddef>

#include "host_tools/lib/reference/fractional_noise.hpp"

namespace zerorate::reference {

/// The weights to which the recursion of FullStateFilter comes, with the calibration mean as its
/// certain mean, found at once: neither the gains nor the covariances of a Kalman filter depend on
/// the data. With Psi = L(psi) split into the calibration's and the later rows,
///
///     C = s_f^2 Psi_1 Psi_1' + r I,   A = s_f^2 Psi_2 Psi_1' C^{-1},
///     predicted = ybar + A (y - ybar 1).
///
/// `variance` is what the filter states. It takes ybar as certain and is therefore too small; see
/// error_variance() for the truth. Time O(samples^2 (samples + leads)).
[[nodiscard]] LinearPredictor make_plug_in_predictor(const FractionalNoise& noise,
                                                     std::size_t samples, std::size_t leads);

}  // namespace zerorate::reference
