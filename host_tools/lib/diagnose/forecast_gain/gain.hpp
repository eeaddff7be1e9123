/// @file
/// Gain of an extension on data that it was not fitted to (docs/design/diagnosis.md,
/// section 8).
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "host_tools/lib/diagnose/forecast_gain/scores.hpp"
#include "host_tools/lib/diagnose/record/record.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

/// Drives and stretches of samples that a gain is of. Two parts in turn, since the best of several
/// chances looks better than it is; each of them sees all that the last part of a record meets,
/// such as a temperature that turns.
enum class HeldOutPart { all, to_choose, to_measure };

/// The last part of a record, in which stops and drives alternate.
class HeldOutDrives {
 public:
  /// @param record  outlives this object
  /// @param holdout  share of the record at its end, in (0, 1)
  HeldOutDrives(const Record& record, double holdout, std::uint64_t seed);

  /// Runs both models through the node's filter. It learns from everything up to the last part of
  /// the record; there it predicts each drive, and the prediction is compared with what was
  /// measured. Intervals by resampling blocks of drives (Künsch 1989), in pairs. Each model is run
  /// once, however often it is compared. Throws ModelCannotRun.
  /// @param base, extended  fitted to the first part
  /// @param learning  on: the gain on the node as it is shipped
  [[nodiscard]] Gain gain(const model::SensorModel& base, const model::SensorModel& extended,
                          HeldOutPart part = HeldOutPart::all, Learning learning = Learning::on);

 private:
  struct Scored {
    model::SensorModel model;
    double level_step_rad_s;
    ScoreOf what;
    Learning learning;
    NodeScores scores;
  };

  [[nodiscard]] ScoredTicks cut(double level_step_rad_s) const;
  const NodeScores& scores(const model::SensorModel& model, const ScoredTicks& ticks, ScoreOf what,
                           Learning learning);

  const Record* record_;
  std::uint64_t seed_;
  core::Duration tick_;
  std::vector<identify::TickMean> means_;
  std::uint32_t judged_from_ = 0;
  std::deque<Scored> scored_;  ///< models scored so far
};

/// Gain on the last part of a record, see HeldOutDrives.
[[nodiscard]] Gain measure_gain(const Record& record, const model::SensorModel& base,
                                const model::SensorModel& extended, double holdout,
                                std::uint64_t seed);

}  // namespace zerorate::diagnose
