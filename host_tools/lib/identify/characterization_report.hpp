/// @file
/// A characterization for people to look at and for other programs to read.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "host_tools/lib/identify/characterize.hpp"
#include "host_tools/lib/report/report.hpp"

namespace zerorate::identify {

/// An estimate as text, in the unit that `unit` of it make: "24.1 [22.8, 25.5]"; without an
/// interval where the figure was not estimated.
[[nodiscard]] std::string text(const IntervalEstimate& estimate, double unit = 1.0);
/// "not detectable" where there is none.
[[nodiscard]] std::string text(const std::optional<IntervalEstimate>& estimate, double unit);

/// The floor of an axis with its interval and averaging time: "25.1 [22.3, 28.9] at 80 s", deg/h;
/// empty without an Allan deviation.
[[nodiscard]] std::string floor_text(const AxisCharacterization& axis);

/// Where the order of a fit comes from, in words.
[[nodiscard]] std::string_view explain(OrderSource source);

[[nodiscard]] report::Report make_report(const Characterization& result,
                                         const std::string& provenance);

/// How a fit came to its order: "given", "estimated", "prior" or "limit".
[[nodiscard]] std::string_view name(OrderSource source);

[[nodiscard]] std::string to_json(const Characterization& result);

/// Allan deviations of all axes as comma-separated values: averaging time [s], deviation and its
/// 95 % interval [deg/s].
[[nodiscard]] std::string allan_csv(const Characterization& result);

}  // namespace zerorate::identify
