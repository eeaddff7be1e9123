/// @file
/// Parameters and capacity that a node is built from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/base/earth_rate.hpp"
#include "core/base/numeric.hpp"
#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "core/estimator/gate.hpp"
#include "core/estimator/prediction.hpp"
#include "core/monitor/odometer_check.hpp"
#include "core/noise/hypotheses.hpp"
#include "core/noise/model_shape.hpp"
#include "core/noise/temperature_drift.hpp"
#include "core/samples/sample_model.hpp"
#include "core/standstill/standstill.hpp"

namespace zerorate::app {

using core::ModelShape;

enum class Predictor : std::uint8_t { kalman, moving_average, calibration_mean };
inline constexpr std::size_t kPredictors = 3;

/// Why parameters cannot be used.
enum class ParamsError : std::uint8_t {
  tick_not_positive,
  tick_shorter_than_sample,
  white_variance_not_positive,
  negative_time,
  no_room_for_samples,  ///< a model of single samples, and NodeCapacity::screens_samples is false
  predictor_not_run,    ///< the published one, by NodeCapacity
  hold_back_too_long,   ///< more than NodeCapacity::held_ticks: slow the filter or shorten it
};

/// Parameters of a node: the model of its sensor, and how it learns.
template <ModelShape Shape>
struct NodeParams {
  core::ModesOf<Shape> modes;                       ///< slow noise at the filter's tick
  float white_variance_rad2_s2 = 0.0F;              ///< white variance of one sample
  float measurement_floor_variance_rad2_s2 = 0.0F;  ///< stays however many samples are averaged
  /// Variance of the change of the bias while the power is off; infinite: unknown, nothing is worth
  /// keeping.
  float turn_on_variance_rad2_s2 = std::numeric_limits<float>::infinity();
  /// Largest magnitude of a bias by the chip's specification. A larger one is learnt and flagged.
  float largest_bias_rad_s = std::numeric_limits<float>::infinity();
  core::Gate gate;  ///< gate of the Kalman predictor; off by default
  /// Dependence on the temperature that the Kalman predictor starts from.
  [[no_unique_address]] core::TemperatureBlock<Shape.temperature_weights> temperature{};
  core::SampleModel samples{};   ///< model of single samples; off by default
  core::Duration sample_period;  ///< nominal; the stamps of the samples decide
  core::Standstill::Params standstill;
  core::OdometerCheck::Params odometer;
  core::EarthRate earth;                    ///< at the vehicle's latitude; zero: not known
  Predictor published = Predictor::kalman;  ///< whose bias corrects the rate
  /// Whether the strength of the white noise is learnt from the calm of the stops. A model of
  /// single samples keeps its own.
  bool learns_white_noise = true;
  /// Slow noises that the sensor may have; none: the model is taken at its word.
  [[no_unique_address]] core::HypothesesOf<Shape> hypotheses{};

  /// Prediction for a vehicle whose heading is not known: the Earth turns a level axis by an
  /// unknown part of its rate.
  [[nodiscard]] constexpr core::Prediction with_earth(core::Prediction bias,
                                                      std::size_t axis) const {
    bias.variance_rad2_s2 += earth.heading_variance_rad2_s2[axis];
    return bias;
  }
  /// Variance of the change of the bias while the power is off; where the model does not know it,
  /// that of the largest bias of the chip, else of any MEMS gyro.
  [[nodiscard]] constexpr float turn_on_variance_or_widest() const {
    constexpr float kLargestOfAny_rad_s = 0.35F;  // 20 deg/s: zero-rate output of the MPU-6050
    if (core::is_finite(turn_on_variance_rad2_s2)) return turn_on_variance_rad2_s2;
    const float largest =
        core::is_finite(largest_bias_rad_s) ? largest_bias_rad_s : kLargestOfAny_rad_s;
    return largest * largest;
  }
  /// Whether a bias is larger than the chip's may be: a turn was taken for one.
  [[nodiscard]] constexpr bool is_beyond_zero_rate(float bias_rad_s) const {
    return bias_rad_s > largest_bias_rad_s || -bias_rad_s > largest_bias_rad_s;
  }
};

/// White noise of the mean of a tick's samples.
struct WhiteNoise {
  float averaged_rad2_s2 = 0.0F;  ///< by the model: the variance that averaging leaves
  float floor_rad2_s2 = 0.0F;     ///< by the model: what averaging does not remove
  float model_level = 1.0F;       ///< by a model of single samples, over its mean
  float level = 1.0F;             ///< variance of a sample, over the model's mean
  bool is_seen = false;           ///< the level is the sensor's own
  bool is_known = false;          ///< and will not be known better

  [[nodiscard]] constexpr float variance(float at_level) const {
    return at_level * averaged_rad2_s2 + floor_rad2_s2;
  }
};

/// White noise of the mean of so many samples: by the screening where single samples have a model,
/// else by the calm inside the stops.
template <ModelShape Shape, class Screening, class Calm>
[[nodiscard]] constexpr WhiteNoise white_noise_of(const NodeParams<Shape>& params,
                                                  const Screening& screening, const Calm& calm,
                                                  float samples) {
  WhiteNoise white{.averaged_rad2_s2 = params.white_variance_rad2_s2 / samples,
                   .floor_rad2_s2 = params.measurement_floor_variance_rad2_s2,
                   .model_level = screening.level(),
                   .level = screening.level()};
  if (params.learns_white_noise && !params.samples.needs_screen()) {
    white.level = calm.white_variance_rad2_s2() / params.white_variance_rad2_s2;
    white.is_seen = calm.has_seen_white_noise();
    white.is_known = calm.knows_white_noise();
  }
  return white;
}

/// How much a node remembers, for boards that count bytes. The results are the same as long as
/// nothing is beyond it.
struct NodeCapacity {
  std::size_t held_ticks = 64;      ///< places of the hold-back line, 32 bytes each
  std::size_t average_levels = 22;  ///< levels of core::SuffixSums, 50 bytes each on every axis
  bool screens_samples = false;  ///< room for NodeParams::samples: 150 bytes, 8 to 12 a held tick
  bool runs_moving_average = true;    ///< 300 bytes an axis and those of average_levels
  bool runs_calibration_mean = true;  ///< 40 bytes an axis

  /// Whether a node of this capacity runs a predictor. The Kalman predictor always runs: what is
  /// learnt, saved and monitored is its own.
  [[nodiscard]] constexpr bool runs(Predictor which) const {
    return which == Predictor::kalman ||
           (which == Predictor::moving_average ? runs_moving_average : runs_calibration_mean);
  }
};

/// Whether a node of this capacity can be built from these parameters.
template <ModelShape Shape>
[[nodiscard]] constexpr core::Result<void, ParamsError> check(const NodeParams<Shape>& params,
                                                              const NodeCapacity& capacity) {
  using core::Unexpected;
  constexpr core::Duration kZero;
  if (params.modes.tick <= kZero || params.sample_period <= kZero) {
    return Unexpected{ParamsError::tick_not_positive};
  }
  if (params.modes.tick < params.sample_period) {
    return Unexpected{ParamsError::tick_shorter_than_sample};
  }
  if (!core::is_measurement(0.0F, params.white_variance_rad2_s2)) {
    return Unexpected{ParamsError::white_variance_not_positive};
  }
  if (!capacity.screens_samples && params.samples.is_on()) {
    return Unexpected{ParamsError::no_room_for_samples};
  }
  if (!capacity.runs(params.published)) return Unexpected{ParamsError::predictor_not_run};
  if (params.standstill.settle < kZero || params.standstill.hold_back < kZero ||
      params.standstill.slowest < kZero) {
    return Unexpected{ParamsError::negative_time};
  }
  // The line holds every tick that has not ended a hold-back ago: those and the one being closed.
  if (params.standstill.hold_back / params.modes.tick + 2 >
      static_cast<std::int64_t>(capacity.held_ticks)) {
    return Unexpected{ParamsError::hold_back_too_long};
  }
  return {};
}

}  // namespace zerorate::app
