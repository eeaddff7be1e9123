/// @file
/// A characterization as a report to look at.
#pragma once

#include <string>
#include <string_view>

#include "host_tools/lib/identify/characterize.hpp"
#include "host_tools/lib/report/report.hpp"

namespace zerorate::identify {

/// An estimate as text, in the unit that `unit` of it make: "24.1 [22.8, 25.5]"; without an
/// interval where the figure was not estimated.
[[nodiscard]] std::string text(const IntervalEstimate& estimate, double unit = 1.0);

/// Where the order of a fit comes from, in words.
[[nodiscard]] std::string_view explain(OrderSource source);

[[nodiscard]] report::Report make_report(const Characterization& result,
                                         const std::string& provenance);

/// How a fit came to its order: "given", "estimated", "prior" or "limit".
[[nodiscard]] std::string_view name(OrderSource source);

[[nodiscard]] std::string to_json(const Characterization& result);

}  // namespace zerorate::identify
