/// @file
/// The density of a noise spectrum at every DCT coefficient.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/noise_spectrum.hpp"

namespace zerorate::diagnose {

/// Densities S_0 .. S_{end-1} of a spectrum; S_0 is infinite. Above the lowest frequencies they are
/// interpolated between nodes, to seven digits.
/// @param sines  2 sin(w/2) of all coefficients of the record
[[nodiscard]] std::vector<double> density_table(const NoiseSpectrum& spectrum,
                                                std::span<const double> sines, std::size_t end);

}  // namespace zerorate::diagnose
