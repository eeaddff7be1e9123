/// @file
/// Characterization of each axis of a sensor from a recording at rest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/time.hpp"
#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/identify/allan_deviation.hpp"
#include "host_tools/lib/identify/density.hpp"
#include "host_tools/lib/identify/innovations_fit.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::identify {

struct AxisCharacterization {
  std::string axis;  ///< "x", "y", "z"; "rate" in a recording of one axis
  InnovationsFit fit;
  model::SensorModel model;  ///< model of the fit, with its sources
  NoiseCoefficients coefficients;
  /// Exact local Whittle estimate of d from the frequencies below half the corner; nothing where
  /// there is no flicker noise or too little of the record is without holes.
  std::optional<Estimate> local_whittle_order;
  std::vector<AllanPoint> allan;     ///< rad/s; of the longest stretch without holes
  std::vector<DensityBin> density;   ///< one-sided, (rad/s)^2/Hz; of the same stretch
  std::vector<std::string> remarks;  ///< limits of these figures, for the user

  /// Point of the Allan deviation with the lowest upper limit. A dip at long averaging times, where
  /// the deviation is uncertain, is not taken for the floor.
  [[nodiscard]] const AllanPoint& allan_floor() const;
};

/// Test of one parameter set for several recordings of one axis, see test_sameness().
struct Sameness {
  static constexpr double kSize = 0.01;  ///< share of sensors without change that fail, all axes

  std::string axis;
  InnovationsFit together;            ///< fitted to all recordings at once
  std::vector<InnovationsFit> alone;  ///< fit of each recording, at the order of `together`
  double likelihood_ratio = 0.0;
  std::size_t degrees_of_freedom = 0;
  double p_value = 1.0;      ///< probability of a ratio this large where nothing has changed
  double threshold = 1.0;    ///< for p: kSize over the number of axes
  model::SensorModel model;  ///< model of `together`

  [[nodiscard]] bool holds() const { return p_value >= threshold; }
};

struct Characterization {
  std::string recording;
  std::uint64_t rows = 0;
  std::uint64_t rows_moving = 0;
  std::uint64_t rows_lost = 0;
  std::uint64_t rows_wild = 0;
  std::uint64_t rows_repeated = 0;  ///< rows of RestSamples::repeated
  std::uint64_t rows_outlying = 0;  ///< rows of RestSamples::outliers
  recording::Findings findings;
  std::vector<std::string> doubts{};  ///< doubts of require_rest(), set by the caller
  core::Duration sample_period;       ///< the mean, see RestSamples
  core::Duration tick;
  std::size_t ticks = 0;  ///< with samples at rest
  double rest_s = 0.0;    ///< time between samples that no drive, pause or hole separates
  std::vector<AxisCharacterization> axes;
  std::vector<std::string> further_recordings;  ///< recordings that the axes were compared with
  std::vector<Sameness> sameness;  ///< sameness of each axis; none without further recordings
};

struct CharacterizeOptions {
  std::string recording;          ///< its name, for the sources of the models
  std::vector<std::size_t> axes;  ///< indices
  std::optional<double> order;    ///< d where it is known
  /// Called now and then with the share of the work that is done.
  std::function<void(double)> on_progress;
};

/// Filter tick at which a record is identified: half a second, like in the node, so that the fit is
/// valid there. It is shorter for records of less than 1024 such ticks, down to the sample period,
/// and doubled beyond 65,536 ticks (9 h) to bound the cost: a mean over seconds keeps all flicker
/// noise that matters over hours.
[[nodiscard]] core::Duration identification_tick(core::Duration span, core::Duration sample_period);
/// Period of the samples, which may come in bursts: never shorter than their mean interval.
[[nodiscard]] core::Duration identification_tick(const RestSamples& samples);

/// Tick means of one axis of a recording.
struct AxisTicks {
  const std::vector<TickMean>& means;
  core::Duration sample_period;  ///< the mean, see RestSamples
  core::Duration tick;
  std::size_t axis = 0;
};

/// Likelihood of one axis, and the starts of a fit.
struct PreparedFit {
  InnovationsLikelihood likelihood;
  InnovationsFitOptions options;
};

[[nodiscard]] PreparedFit prepare_fit(const AxisTicks& ticks, std::optional<double> order);

/// White and flicker noise of one axis: the base that characterize() and the diagnosis share.
/// It is fitted to tick means, which the sensor's low-pass, fast lines and rounding leave alone.
/// @param order  d where it is known
[[nodiscard]] InnovationsFit fit_noise(const AxisTicks& ticks, std::optional<double> order = {});

/// Tests whether the noise of an axis has the same strengths in several recordings, by the ratio of
/// the likelihoods of one parameter set for each and of one for all. The order of the flicker noise
/// is that of the fit to all, so that white and flicker noise are compared: 2 (recordings - 1)
/// degrees of freedom. Where flicker noise is too weak to be seen the ratio is smaller than chi
/// squared, and the test errs towards "the same".
/// @param recordings  of one axis, at least two
[[nodiscard]] Sameness test_sameness(std::span<const AxisTicks> recordings,
                                     std::optional<double> order = {});

/// Compares a characterized recording with further recordings of the same sensor, and sets the
/// results for each of its axes.
/// @param samples  of the recording that was characterized
void compare_recordings(const RestSamples& samples, std::span<const RestSamples> further,
                        const CharacterizeOptions& options, Characterization& result);

/// Model of a fit, with its sources.
[[nodiscard]] model::SensorModel model_of(const InnovationsFit& fit, core::Duration sample_period,
                                          const std::string& recording, const std::string& axis);

/// Samples without_repeats() and without find_outliers(); where the sensor was at rest all the
/// time, without find_wild_stretches(). Throws recording::DataError where they are more than 5 %.
[[nodiscard]] RestSamples measurements_of(const RestSamples& all);

/// Identifies each axis, outliers left out, by the innovations likelihood, from the Whittle fit of
/// its longest stretch without holes. The white noise is that of tick means on purpose: at the raw
/// rate it contains the sensor's low-pass and quantization, which are averaged out at the tick.
/// Time about 1 s an axis for 10^6 samples. Throws recording::DataError for records that are too
/// short or constant.
[[nodiscard]] Characterization characterize(const RestSamples& all,
                                            const CharacterizeOptions& options);

/// Throws recording::DataError where the white noise of an axis is known within a factor of 100
/// only (95 % interval): what the gyro took for its own rest was none.
void require_noise_of_rest(const Characterization& result);

/// The axis whose flicker noise at 0.01 Hz is the middle one (the higher of two): where one model
/// must serve all axes, it errs least in either direction.
[[nodiscard]] const AxisCharacterization& middle_axis(const Characterization& result);

}  // namespace zerorate::identify
