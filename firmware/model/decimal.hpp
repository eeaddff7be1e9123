/// @file
/// Numbers of a model file: decimal text in human units on the one side, SI doubles on the other.
///
/// A plain `value * kRadPerDeg` would lose a bit in one of ten values on the way out and back
/// again: the factor stretches the spacing of doubles. So the text is the number, converted with
/// 113 bits and rounded once, on every machine alike.
#pragma once

#include <string>
#include <string_view>

namespace zerorate::model {

/// One unit of the text in SI.
enum class FileUnit {
  si,                     ///< 1
  percent,                ///< 1 / 100
  degree,                 ///< pi / 180
  degree_per_hour,        ///< pi / 180 / 3600
  degree_per_hour_floor,  ///< deg/h of Allan floor: pi / 180 / 3600 / sqrt(2 ln 2 / pi) of B
};

/// The double nearest to `decimal` (as in "0.05" or "2.5e-3") in SI.
/// Throws std::runtime_error where the text is not a decimal number.
[[nodiscard]] double si_from_decimal(std::string_view decimal, FileUnit unit);

/// A number in SI in the unit of the file, to double precision.
[[nodiscard]] double in_unit(double si, FileUnit unit);

/// The shortest decimal from which si_from_decimal gives exactly `si`, which must be finite.
[[nodiscard]] std::string decimal_from_si(double si, FileUnit unit);

}  // namespace zerorate::model
