#include "firmware/model/decimal.hpp"

#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>

namespace zerorate::model {
namespace {

using Quad = boost::multiprecision::cpp_bin_float_quad;

Quad si_per_unit(FileUnit unit) {
  using boost::math::constants::ln_two;
  using boost::math::constants::pi;
  Quad degree = pi<Quad>() / 180;
  switch (unit) {
    case FileUnit::percent:
      return Quad{1} / 100;
    case FileUnit::degree:
      return degree;
    case FileUnit::degree_per_hour:
      return degree / 3600;
    case FileUnit::degree_per_hour_floor:
      return degree / 3600 / sqrt(2 * ln_two<Quad>() / pi<Quad>());
    case FileUnit::si:
      break;
  }
  return 1;
}

}  // namespace

double si_from_decimal(std::string_view decimal, FileUnit unit) {
  return static_cast<double>(Quad(std::string(decimal)) * si_per_unit(unit));
}

double in_unit(double si, FileUnit unit) {
  if (unit == FileUnit::si) return si;
  return si / static_cast<double>(si_per_unit(unit));
}

std::string decimal_from_si(double si, FileUnit unit) {
  const Quad exact = Quad(si) / si_per_unit(unit);
  // "600", not "6e+02", up to a million.
  const auto shown = static_cast<double>(exact);
  const int integer_digits =
      shown >= 1.0 && shown < 1e6 ? static_cast<int>(std::log10(shown)) + 1 : 1;
  // Decimals of 18 digits lie closer to each other than doubles do, so the loop ends.
  for (int digits = integer_digits;; ++digits) {
    std::string decimal = exact.str(digits);
    if (si_from_decimal(decimal, unit) == si) {
      return decimal;
    }
  }
}

}  // namespace zerorate::model
