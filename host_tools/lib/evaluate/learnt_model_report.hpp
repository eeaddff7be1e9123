/// @file
/// Learnt noise model as a part of a replay's report.
#pragma once

#include <vector>

#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/evaluate/replay_trace.hpp"
#include "host_tools/lib/report/report.hpp"

namespace zerorate::evaluate {

/// Adds a section: a table of the axes by the end of the replay, and how the traced axis came to
/// its figures, stop by stop. Adds nothing where nothing was learnt.
/// @param axes those to tabulate
void add_learnt_model(report::Report& report, const ReplayResult& result,
                      const std::vector<std::size_t>& axes, const ReplayTrace& trace);

}  // namespace zerorate::evaluate
