/// @file
/// Contests on drives as people and programs read them: the results, and the parts that every
/// contest shares.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "host_tools/lib/contest/drives.hpp"
#include "host_tools/lib/contest/learning.hpp"
#include "host_tools/lib/evaluate/odometer.hpp"
#include "host_tools/lib/report/presentation.hpp"
#include "host_tools/lib/report/table.hpp"

namespace zerorate::contest {

using report::Presentation;

/// Presents a contest; JSON of the schema zerorate.drives/1.
[[nodiscard]] Presentation present(const DriveContest& contest);
/// Presents what learning is worth; JSON of the schema zerorate.learning/1.
[[nodiscard]] Presentation present(const LearningContest& contest);

/// Mean lengths of stop and drive, as in 30/120.
[[nodiscard]] std::string label(const evaluate::ScheduleParams& schedule);
[[nodiscard]] std::string axis_label(std::size_t axis);

/// Appends value and ends of an interval.
void append(std::vector<report::Cell>& row, const BootstrapFigure& figure);
/// A bar with its interval.
void append(report::BarGroup& group, const BootstrapFigure& figure);

/// Adds a figure and its interval, as `key` and `key_ci95`.
void add(nlohmann::ordered_json& into, const std::string& key, const BootstrapFigure& figure);

[[nodiscard]] nlohmann::ordered_json to_json(const DriveStanding& standing);

/// Table of the noise fitted to each recording.
[[nodiscard]] report::Table fits_table(const std::vector<DriveContest::AxisModels>& fits);

}  // namespace zerorate::contest
