/// @file
/// Mean functions of time as columns of DCT coefficients.
#pragma once

#include <functional>
#include <span>
#include <utility>

#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"

namespace zerorate::diagnose {

/// The DCT of a slow function of time given at each value. Of long records it is taken of the means
/// over blocks, and coefficients beyond half of theirs are left out.
[[nodiscard]] Column column_of(const FitData& data, std::span<const double> values);
/// Column of a function that is smooth over a block.
[[nodiscard]] Column column_of(const FitData& data,
                               const std::function<double(double time_s)>& function);
/// Column of a fast function, with all coefficients.
[[nodiscard]] Column fast_column_of(const FitData& data,
                                    const std::function<double(double time_s)>& function);
/// Column of a step: 0 before value `first` and 1 from it on.
[[nodiscard]] Column step_column(const FitData& data, std::size_t first);
/// Columns of cosine and sine of a tone, `cycles` a value; coefficients far from its frequency are
/// left out.
[[nodiscard]] std::pair<Column, Column> tone_columns(const FitData& data, double cycles);
/// Column of e^(-t / tau).
[[nodiscard]] Column decay_column(const FitData& data, double tau_s);

}  // namespace zerorate::diagnose
