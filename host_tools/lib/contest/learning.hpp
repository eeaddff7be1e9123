/// @file
/// Worth of learning: a node that starts from nothing with the figures of a data sheet, right or
/// wrong, against filters whose noise model is known.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/contest/drives.hpp"
#include "host_tools/lib/evaluate/learnt_model.hpp"

namespace zerorate::contest {

/// Error of a data sheet: factors on its white noise N and its flicker noise B.
struct DataSheetError {
  double white = 1.0;
  double flicker = 1.0;
};

struct LearningOptions {
  /// Figures of the data sheet, the centre of the prior.
  model::SensorModel model;
  std::vector<DataSheetError> cases{{}};
  DriveContestOptions drives;  ///< fit_on and fit_by are not used: both origins take part
};

/// Contestants with a model that does not depend on the data sheet.
enum class Tuned : std::uint8_t {
  on_others,  ///< decade filter with the means of the models fitted to the other recordings
  hindsight,  ///< decade filter with the model fitted to the same recording
};
inline constexpr std::size_t kTuned = 2;
[[nodiscard]] std::string_view name(Tuned tuned);

/// Standings of one contestant.
struct LearningStandings {
  std::vector<DriveStanding> by_schedule;
  DriveStanding overall;
  DriveStanding first_drives;      ///< first drives of each run: LearningContest::kFirstDrives
  BootstrapFigure over_on_others;  ///< ratio of its drift to that of Tuned::on_others
};

/// Model that a node had learnt by the end of one run.
struct LearntRun {
  std::size_t recording;
  std::size_t axis;
  std::size_t schedule;
  std::uint64_t seed;
  evaluate::LearntModel model;
};

struct LearningContest {
  static constexpr std::size_t kFirstDrives = 5;

  struct Case {
    DataSheetError error;
    LearningStandings learning;
    LearningStandings fixed;  ///< the filter that takes the same data sheet at its word
    std::vector<LearntRun> runs;
  };

  LearningOptions options;
  std::vector<std::string> recordings;
  std::vector<DriveContest::AxisModels> fits;
  std::size_t drives = 0;  ///< drives of each contestant
  std::array<LearningStandings, kTuned> tuned;
  std::vector<Case> cases;
};

/// Replays each recording under every schedule and seed through the node, each time from nothing.
/// Cost: 2 replays a recording, schedule, seed and axis, and 2 a recording, schedule, seed and
/// case, on all threads; beside a fit of each recording. Throws recording::Error;
/// std::invalid_argument if there are fewer than two recordings, no drive was made, a factor is
/// impossible, or the model leaves nothing to learn.
[[nodiscard]] LearningContest run_learning_contest(
    const std::vector<std::filesystem::path>& recordings, const LearningOptions& options,
    const parallel::Progress& progress);

}  // namespace zerorate::contest
