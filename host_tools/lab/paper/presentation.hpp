/// @file
/// The results for the paper as people and programs read them.
#pragma once

#include <vector>

#include "host_tools/lab/paper/figures.hpp"
#include "host_tools/lab/paper/measured_sets.hpp"
#include "host_tools/lab/paper/table1.hpp"
#include "host_tools/lib/report/presentation.hpp"

namespace zerorate::paper {

using report::Presentation;

/// Everything that `reproduce table1` finds.
struct Table1 {
  SimulationOptions options;
  std::vector<SimulatedStanding> simulated;
  std::vector<OrderStanding> orders;
  std::vector<FilterCost> costs;
  std::vector<MeasuredTable> measured;  ///< empty without recordings
};

[[nodiscard]] Presentation present(const Table1& table);
[[nodiscard]] Presentation present(const std::vector<AllanCurve>& curves);
/// @param number of the figure in the paper, 2 or 3
[[nodiscard]] Presentation present(const ExampleRun& run, int number);

}  // namespace zerorate::paper
