/// @file
/// A recording through the firmware: the node's own step function, optionally behind the simulated
/// chip and the real driver.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/earth_rate.hpp"
#include "core/base/time.hpp"
#include "firmware/app/gyro_node.hpp"
#include "firmware/app/learnt_noise.hpp"
#include "firmware/app/node_loop.hpp"
#include "firmware/app/rate_message.hpp"
#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/evaluate/drive_scores.hpp"
#include "host_tools/lib/evaluate/learnt_model.hpp"
#include "host_tools/lib/evaluate/odometer.hpp"
#include "host_tools/lib/evaluate/simulated_gyro.hpp"
#include "host_tools/lib/evaluate/true_drives.hpp"
#include "host_tools/lib/identify/rest_check.hpp"
#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/truth/truth.hpp"

namespace zerorate::evaluate {

inline constexpr std::array kAllPredictors = {
    app::Predictor::kalman, app::Predictor::moving_average, app::Predictor::calibration_mean};
[[nodiscard]] std::string_view name(app::Predictor predictor);

/// How a sample reaches the node.
enum class Through : std::uint8_t {
  source,  ///< handed over directly
  chip,    ///< converted by a simulated chip, read by its driver, stepped by the node's loop
};

/// Headings of a recording's reference that the node learns from.
struct ReferenceUse {
  bool only_at_stops = false;
  truth::VerticalAxis vertical;  ///< axis and sense of the reference
  double sigma_rad = 0.0;        ///< standard deviation of a heading
};

struct ReplayOptions {
  model::SensorModel model;
  bool is_model_chosen = true;  ///< false: nobody named one, the model is a default
  /// Nominal samples per second, which a node takes from its chip; nullopt: by the recording's mean
  /// interval.
  std::optional<double> sample_rate_hz;
  /// Filter ticks per second; nullopt: 2, or the sensor's rate if that is lower.
  /// Shorter ticks than the model's shortest flicker decade only cost time.
  std::optional<double> filter_rate_hz;
  std::optional<ScheduleParams> schedule;
  /// With a schedule: whether the rates are to be looked at, which those of a sensor at rest must
  /// be.
  bool checks_rest = false;
  identify::AcceptedDoubts accepted{};  ///< doubts about rest that the user overrules
  Through through = Through::source;
  /// If through chip: a SimulatedChip's name, with as many axes as the recording.
  std::string chip = "lsm6dso";
  bool has_data_ready = true;  ///< if through chip; false: the wire of its pin is broken
  app::Predictor published = app::Predictor::kalman;
  core::Standstill::Params standstill;
  /// With a schedule pulses without motion are not checked: the sensor was at rest.
  core::OdometerCheckParams odometer;
  core::EarthRate earth;                   ///< zero: the latitude is not known
  std::optional<core::UpAxis> up;          ///< vertical axis; none: not known
  std::optional<ReferenceUse> references;  ///< nullopt: they only score
  bool learns_noise = true;  ///< false: the strengths of the noise stay those of the model
};

/// One row of the recording after the node.
struct ReplayedSample {
  std::uint64_t row;     ///< row of the recording, from 0
  std::int64_t time_ns;  ///< time in the recording; the node's clock is shifted
  bool moving;           ///< state in the recording or the schedule
  const app::RateMessage& message;
  /// Not a number where it is not known: without a true rate, a schedule or a reference's rate.
  std::array<float, 3> true_rate_rad_s;
  std::array<float, 3> last_stop_mean_rad_s;  ///< bias of the calibration mean
  std::uint32_t learnt_ticks;  ///< filter ticks up to and with the newest one that was learnt
};

/// Whether the vehicle moves, sample by sample: by the recording from where that says so on, and by
/// the node before. A node calls the first second of each stop moving, too.
class MotionOfReplay {
 public:
  [[nodiscard]] bool moves(const ReplayedSample& sample) {
    is_recorded_ = is_recorded_ || sample.moving;
    return is_recorded_ ? sample.moving : sample.message.motion == core::Motion::moving;
  }

 private:
  bool is_recorded_ = false;
};

/// One predictor's outcome over one drive of one axis.
struct ReplayedDrive {
  std::size_t axis;
  app::Predictor predictor;
  std::int64_t start_ns;  ///< time in the recording
  DriveOutcome outcome;
  double length_s = 0.0;
  double measured_rad = 0.0;  ///< integral of the measured rate, bias included, less the true turn
};

/// The first seconds of a stop against what was predicted before it.
struct ReplayedStop {
  std::array<double, 3> measured_rad_s{};
  /// Measured bias less the predicted one, by axis and predictor; NaN where there was none.
  std::array<std::array<double, app::kPredictors>, 3> error_rad_s{};
  std::array<std::array<double, app::kPredictors>, 3> sigma_rad_s{};  ///< see StopScores::add()
};

/// Scale factor and offset that references taught a node by the end, and their outcomes.
struct LearntMotion {
  double scale_factor = 0.0;  ///< error of it; 0.01: 1 % too much
  double scale_factor_sigma = 0.0;
  double offset_rad_s = 0.0;  ///< offset of the bias in motion
  double offset_sigma_rad_s = 0.0;
  double quality = 0.0;  ///< quality of the scale factor: 0 as by the model, 1 exact
  std::uint64_t learnt = 0;
  std::uint64_t refused = 0;
  std::uint64_t unusable = 0;  ///< before the first bias, or of a time that is not remembered
};

/// Noise of each axis as the node has learnt it.
using LearntNoises = std::array<app::LearntNoise, 3>;

/// Noise that a node had learnt when a stop was over.
struct LearntStop {
  std::int64_t time_ns;  ///< time in the recording
  const LearntNoises& axes;
  const LearntMesh& mesh;
};

/// The vehicle's true rate at a row of the recording [rad/s].
using TrueRate = std::function<std::array<float, 3>(std::uint64_t row)>;

struct ReplayObserver {
  /// The true rate at a row (counted from 0) [rad/s]; unset: zero, the sensor was at rest.
  TrueRate true_rate;
  /// True drives by a reference system, to be scored besides; unset: none.
  std::optional<truth::Truth> truth;
  std::function<void(const ReplayedSample&)> on_sample;
  std::function<void(const ReplayedDrive&)> on_drive;
  std::function<void(const ReplayedStop&)> on_stop;
  /// Called at the end of each stop and of the recording, if something was learnt since.
  std::function<void(const LearntStop&)> on_learnt;
  /// Called now and then with the share of the recording that is done, if known.
  std::function<void(std::optional<double>)> on_progress;
};

struct ReplayResult {
  std::string model;  ///< its name
  bool is_model_chosen = true;
  bool states_scale_factor = true;  ///< false: the model leaves the default tolerance
  std::size_t axis_count = 3;
  core::Duration sample_period;  ///< mean interval of the first rows, holes left out
  core::Duration filter_tick;
  std::uint64_t rows = 0;
  std::uint64_t samples_refused = 0;  ///< refused by the node: not finite, or out of time order
  std::uint64_t samples_saturated = 0;
  /// Time in which the node reported that the sensor does not behave like its model (see
  /// InnovationMonitor).
  std::uint64_t samples_inconsistent = 0;
  double first_inconsistent_s = 0.0;  ///< after the first row; only if there are any
  std::uint64_t samples_doubted =
      0;  ///< while the gate held back the newest measurement of an axis
  std::uint64_t samples_without_temperature = 0;   ///< samples without one that the model needs
  std::uint64_t samples_without_acceleration = 0;  ///< likewise
  std::uint64_t samples_frozen = 0;       ///< samples without a rate: an axis no longer measures
  double first_frozen_s = 0.0;            ///< time of the first of them since the first row
  std::uint64_t samples_disagreeing = 0;  ///< while gyro and odometer contradicted each other
  std::uint64_t rows_corrected = 0;       ///< rows with a corrected rate
  recording::Findings findings;
  app::LoopCounters loop;  ///< counters of the chip's loop; zero if through source
  /// Whether the true rate was known, so that the scores mean something.
  bool truth_known = false;
  std::array<std::array<DriveScores, app::kPredictors>, 3> scores;  ///< axis, predictor
  /// Predictions against the next stop, by axis and predictor; they need no truth.
  std::array<std::array<StopScores, app::kPredictors>, 3> stop_scores;
  /// Doubts about rest that are not certain, if the options ask for them.
  std::vector<std::string> rest_doubts;
  std::optional<TrueDrives> true_drives;      ///< if the observer gave the truth
  std::optional<LearntMotion> learnt_motion;  ///< if the options have references
  /// Noise as learnt by the end; nullopt where the model was taken at its word, or nothing
  /// measured.
  std::optional<LearntNoises> learnt;
  LearntMesh mesh;  ///< grid of noises that the node tried
};

/// Replays to the end of the recording in constant memory. Throws recording::Error,
/// recording::DataError for rates that are certainly not of rest where the options ask for that,
/// and std::invalid_argument. Truth is known if the observer gives it or the options have a
/// schedule, which requires a sensor at rest.
[[nodiscard]] ReplayResult replay(recording::Reader& reader, const ReplayOptions& options,
                                  const ReplayObserver& observer = {});

}  // namespace zerorate::evaluate
