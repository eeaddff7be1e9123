/// @file
/// The node against predictors that people have already, on their own logs: by the bias that the
/// next stop shows, and by a reference's heading where there is one.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host_tools/lib/contest/paired_ratio.hpp"
#include "host_tools/lib/contest/presentation.hpp"
#include "host_tools/lib/contest/rival.hpp"
#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/parallel/parallel.hpp"
#include "host_tools/lib/recording/input.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/truth/truth.hpp"

namespace zerorate::contest {

struct ComparisonOptions {
  evaluate::ReplayOptions replay;
  Rival rival;
  std::string axis = "all";   ///< x, y, z or all
  recording::Input format{};  ///< layout of every log; its path does not count
  truth::TruthOptions truth{};
  unsigned threads = 0;  ///< 0: as many as the machine has
};

/// One contestant. Ratios are of root mean squares, with 95 % intervals over logs, or over stops
/// where there are fewer than evaluate::kFewestDrivesOfARatio logs.
struct ContestantScore {
  std::string name;
  double stop_error_rad_s = 0.0;           ///< error of the next stop's bias, root mean square
  statistics::BootstrapFigure stop_ratio;  ///< error over that of the rival
  double heading_error_rad = 0.0;          ///< root mean square; NaN without a reference
  statistics::BootstrapFigure
      heading_ratio;  ///< error over that of the rival; NaN without a reference
};

/// Quantity that the logs hold and the model leaves out.
struct UnusedInput {
  std::string quantity;               ///< temperature or acceleration
  std::string table;                  ///< addition to the model file
  statistics::BootstrapFigure ratio;  ///< error of the next stop with it, over that without
};

struct Comparison {
  std::string model;
  Rival rival;
  std::vector<std::string> logs;
  std::size_t stops = 0;
  std::size_t drives = 0;   ///< drives with a known turn
  double coverage95 = 0.0;  ///< share of the next stops' biases in the node's interval
  std::vector<ContestantScore> contestants;  ///< kalman, moving_average, and the rival last
  std::vector<UnusedInput> unused_inputs;
  std::optional<ScaleInTurns> scale;  ///< error of the scale factor beyond the model's, by turns
  std::string scale_table;            ///< lines of a model file that take it off
};

/// Replays every log, and once more with each quantity that the model leaves out. Throws
/// recording::Error and recording::DataError, which name the log, and std::invalid_argument.
[[nodiscard]] Comparison compare(const std::vector<std::string>& logs,
                                 const ComparisonOptions& options,
                                 const parallel::Progress& progress = {});

/// Presents a comparison; JSON of the schema zerorate.comparison/1.
[[nodiscard]] Presentation present(const Comparison& comparison);

}  // namespace zerorate::contest
