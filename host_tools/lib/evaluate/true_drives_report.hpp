/// @file
/// Drives that were scored against a reference system, for a report and for a terminal.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/evaluate/replay_trace.hpp"
#include "host_tools/lib/evaluate/true_drives.hpp"
#include "host_tools/lib/report/report.hpp"

namespace zerorate::evaluate {

/// Sentence about drives of the Kalman predictor that lie outside their 95 % intervals more often
/// than by chance (p < 0.001, Poisson), with what looks for the cause; empty otherwise.
[[nodiscard]] std::string doubt_of_coverage(const TrueDrives& drives);

/// The result in one sentence, with doubt_of_coverage(), or, where nothing is scored, the reason.
[[nodiscard]] std::string summary(const TrueDrives& drives, std::size_t axis_count);

/// Stops by odometer and by the reference, and what was learnt in them, along the time.
[[nodiscard]] report::Chart stop_chart(const ReplayTrace& trace, const TrueDrives& drives,
                                       double filter_tick_s);

/// Adds a section with the scores of the drives.
void add_true_drives(report::Report& report, const TrueDrives& drives, const ReplayTrace& trace,
                     const ReplayResult& result);

/// The key `true_drives` of zerorate.replay/1, described in docs/reference/replay-json.md.
[[nodiscard]] nlohmann::ordered_json true_drives_json(const TrueDrives& drives,
                                                      std::size_t axis_count);

}  // namespace zerorate::evaluate
