/// @file
/// A model through the node's filter over a record with stops and drives.
#pragma once

#include <cstddef>
#include <span>
#include <stdexcept>
#include <vector>

#include "core/base/time.hpp"
#include "core/samples/sample_screen.hpp"
#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::diagnose {

/// Ticks of one axis, and from which on the model is judged.
struct ScoredTicks {
  std::span<const identify::TickMean> ticks;  ///< the axis is the first one
  std::span<const double> rate_rad_s;         ///< the samples of the ticks, one after the
                                              ///< other; none where no model asks for them
  std::span<const float> temperature_degc;    ///< mean of each tick; none: there is no thermometer
  double level_step_rad_s = 0.0;              ///< of the levels that the samples lie on; 0: none
  core::Duration sample_period;
  core::Duration tick;
  std::uint32_t judged_from = 0;  ///< tick; everything before it is a stop
  std::uint32_t stop_ticks = 1;
  std::uint32_t drive_ticks = 1;
};

/// One drive: what the filter had predicted at its beginning, against what was measured.
struct ScoredDrive {
  double integrated_rad = 0.0;   ///< heading error: measured minus predicted, integrated
  double sigma_rad = 0.0;        ///< as predicted, white noise and temperature included
  double squares_rad2_s2 = 0.0;  ///< sum of squared errors of the tick means
  std::size_t ticks = 0;
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

/// The drives alone: one pass. Throws ModelCannotRun.
[[nodiscard]] std::vector<ScoredDrive> score_drives(const model::SensorModel& model,
                                                    const ScoredTicks& ticks);

/// Two passes of the node's filter, in its single precision. Throws ModelCannotRun.
[[nodiscard]] NodeScores score(const model::SensorModel& model, const ScoredTicks& ticks,
                               ScoreOf what);

/// Scale that readings are read off; by default a reading is the rate itself.
struct Scale {
  double step_rad_s = 0.0;  ///< of what readings are rounded to; 0: they are not
  /// Spacing of the levels that readings lie on, where the model does not know of them: its density
  /// at the levels is made to sum to 1. 0: there are none.
  double unknown_step_rad_s = 0.0;
  double rounding_variance = 0.0;  ///< what the variance of a forecast holds of that
  /// Width of the cell that a reading at the end of the range stands for, where nothing is rounded.
  double end_cell_rad_s = 0.0;
  core::MeasuringRange range;
};

/// Log density of a reading, or the log of its probability over the width of its cell: rounded, it
/// stands for half a step on both sides, at an end of the range for all beyond. So densities and
/// probabilities can be compared, and each sums to 1 over all readings (Dawid 1984: prequential).
/// The mean of the readings is expected, because the filter learns it.
[[nodiscard]] double log_score(const core::SampleScreen::Forecast& forecast, double reading_rad_s,
                               const Scale& scale);

}  // namespace zerorate::diagnose
