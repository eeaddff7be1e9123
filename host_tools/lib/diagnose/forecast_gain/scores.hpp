/// @file
/// A model through the node's filter over a record with stops and drives.
#pragma once

#include <cstddef>
#include <span>
#include <stdexcept>
#include <vector>

#include "core/base/time.hpp"
#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::diagnose {

/// Ticks of one axis, and from which on the model is judged.
struct ScoredTicks {
  std::span<const identify::TickMean> ticks;  ///< the axis is the first one
  std::span<const double> rate_rad_s;         ///< the samples of the ticks, one after the
                                              ///< other; none where no model asks for them
  /// Temperature of each sample of the ticks; none: there is no thermometer.
  std::span<const double> temperature_degc;
  double level_step_rad_s = 0.0;  ///< spacing of the levels of the samples; 0: none
  core::Duration sample_period;
  core::Duration tick;
  std::uint32_t judged_from = 0;  ///< tick; everything before it is a stop
  std::uint32_t stop_ticks = 1;
  std::uint32_t drive_ticks = 1;
};

/// One drive: what the filter had predicted at its beginning, against what was measured.
struct ScoredDrive {
  double integrated_rad = 0.0;   ///< heading error: measured minus predicted, integrated
  double sigma_rad = 0.0;        ///< predicted, white noise and temperature included
  double squares_rad2_s2 = 0.0;  ///< sum of squared errors of the tick means
  std::size_t ticks = 0;
};

/// Way in which the node runs a model.
enum class Learning {
  off,  ///< takes the model at its word
  on,   ///< learns the noise from the stops, as it is shipped
};

/// Object of a log score, which is the same for all models that are compared.
enum class ScoreOf {
  tick_means,  ///< for models that take what is within a tick for white noise
  samples,     ///< each after those before it
};

/// A model that the node cannot run, and why.
class ModelCannotRun : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct NodeScores {
  std::vector<ScoredDrive> drives;
  /// Score of each judged tick when all of them are stops: log density of its mean, or the sum of
  /// the log scores of its samples (see log_score()), as predicted from the ticks and samples
  /// before.
  std::vector<double> log_scores;
};

/// Object of a model's score: samples if the model says more of them than white noise.
[[nodiscard]] ScoreOf level_of(const model::SensorModel& model);

/// The drives alone: one pass of app::TickNode that takes the model at its word. Throws
/// ModelCannotRun.
[[nodiscard]] std::vector<ScoredDrive> score_drives(const model::SensorModel& model,
                                                    const ScoredTicks& ticks);

/// Drives, and log scores of a node that stands all the time: one pass of app::TickNode up to where
/// the model is judged, and two from there. Throws ModelCannotRun.
[[nodiscard]] NodeScores score(const model::SensorModel& model, const ScoredTicks& ticks,
                               ScoreOf what, Learning learning);

}  // namespace zerorate::diagnose
