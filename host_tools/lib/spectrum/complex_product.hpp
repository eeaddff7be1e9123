/// @file
/// Product of complex numbers.
#pragma once

#include <complex>

namespace zerorate::spectrum {

/// Product without the rules for NaN and infinity of std::complex's operator*, which take a call.
[[nodiscard]] inline std::complex<double> product(std::complex<double> a, std::complex<double> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

}  // namespace zerorate::spectrum
