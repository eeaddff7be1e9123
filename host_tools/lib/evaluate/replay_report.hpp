/// @file
/// A replay as a report to look at.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/evaluate/replay_trace.hpp"
#include "host_tools/lib/report/report.hpp"

namespace zerorate::evaluate {

/// Text of the report besides the figures of the replay.
struct ReplayReportText {
  std::string title;
  std::string lead;  ///< one paragraph; the result sentence follows it
  std::string provenance;
};

/// Rates of the traced axis at rest, evenly spaced, for the Allan deviation; empty: no such chart.
struct RestRecord {
  std::span<const double> rate_rad_s;
  double sample_period_s = 0.0;
  std::string caption;
};

/// The result in one sentence, for report and terminal alike.
[[nodiscard]] std::string summary(const ReplayResult& result, std::size_t axis);

/// @param axes those to tabulate; the charts show the traced one
[[nodiscard]] report::Report make_report(const ReplayResult& result,
                                         const std::vector<std::size_t>& axes,
                                         const ReplayTrace& trace, const RestRecord& rest,
                                         const model::SensorModel& model,
                                         const ReplayReportText& text);

/// Adds a section: a table of the axes by the end of the replay, and how the traced axis came to
/// its figures, stop by stop. Adds nothing where nothing was learnt.
/// @param axes those to tabulate
void add_learnt_model(report::Report& report, const ReplayResult& result,
                      const std::vector<std::size_t>& axes, const ReplayTrace& trace);

}  // namespace zerorate::evaluate
