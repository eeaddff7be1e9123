/// @file
/// Standings and fits as people and programs read them, for every contest on drives.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "host_tools/lib/evaluate/schedule.hpp"
#include "host_tools/lib/experiments/drives/drives.hpp"
#include "host_tools/lib/report/table.hpp"

namespace zerorate::experiments {

/// Mean lengths of stop and drive, as in 30/120.
[[nodiscard]] std::string label(const evaluate::ScheduleParams& schedule);
[[nodiscard]] std::string axis_label(std::size_t axis);

/// Appends value and ends of an interval.
void append(std::vector<report::Cell>& row, const BootstrapFigure& figure);

/// Adds a figure and its interval, as `key` and `key_ci95`.
void add(nlohmann::ordered_json& into, const std::string& key, const BootstrapFigure& figure);

[[nodiscard]] nlohmann::ordered_json to_json(const DriveStanding& standing);

/// Table of the noise fitted to each recording.
[[nodiscard]] report::Table fits_table(const std::vector<DriveContest::AxisModels>& fits);

}  // namespace zerorate::experiments
