/// @file
/// Names of columns that say what they hold, and in which unit.
#pragma once

#include <optional>
#include <string_view>

#include "host_tools/lib/recording/layout.hpp"

namespace zerorate::recording {

/// Quantity that a name stands for: a name of zerorate's format, or one of other formats with its
/// unit in brackets behind it; nullptr for any other name.
[[nodiscard]] const Quantity* quantity_in_name(std::string_view name);

/// Unit that a name gives to a quantity of this dimension; nullopt where it gives none.
[[nodiscard]] std::optional<Unit> unit_in_name(Dimension dimension, std::string_view name);

/// Whether a name begins, in any case, with a stem in lower case.
[[nodiscard]] bool begins_with(std::string_view name, std::string_view lower_case_stem);

}  // namespace zerorate::recording
