/// @file
/// A replay for Python: its scores, and what each stop and drive had.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host_tools/python/node.hpp"
#include "host_tools/python/source.hpp"

namespace zerorate::python {

/// Figures by name, one behind the other: of each row, of each stop that was judged (the period of
/// rest before its drive, from 0 on, and for each axis the measured bias and the errors of the
/// predictors), of each drive of a schedule and of each drive against a reference. SI units.
using Details = std::map<std::string, std::vector<double>>;

/// JSON of the schema zerorate.replay/1, and the figures behind it.
[[nodiscard]] std::pair<std::string, Details> evaluate_recording(
    const Source& source, const std::string& axis, const std::optional<std::string>& schedule,
    const NodeOptions& options, const std::string& vertical_axis,
    std::optional<double> reference_error_deg, double reference_from_s);

}  // namespace zerorate::python
