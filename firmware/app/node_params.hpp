/// @file
/// Parameters and capacity that a node is built from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/earth_rate.hpp"
#include "core/base/numeric.hpp"
#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "core/model/node_model.hpp"
#include "core/monitor/odometer_check.hpp"
#include "core/noise/model_shape.hpp"
#include "core/standstill/hold_back_line.hpp"
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
  no_accelerometer,     ///< a term follows the acceleration, and the shape has none
  predictor_not_run,    ///< the published one, by NodeCapacity
  hold_back_too_long,   ///< more than NodeCapacity::held_ticks: slow the filter or shorten it
};

/// Why, in words for a message.
[[nodiscard]] constexpr std::string_view reason(ParamsError error) {
  switch (error) {
    case ParamsError::tick_not_positive:
    case ParamsError::tick_shorter_than_sample:
      return "the filter tick must be positive and not shorter than the sample period";
    case ParamsError::white_variance_not_positive:
      return "the model's white noise must be positive";
    case ParamsError::no_room_for_samples:
      return "the model describes single samples, and the node has no room for that";
    case ParamsError::no_accelerometer:
      return "the model follows the acceleration, and the node has no room for that";
    case ParamsError::predictor_not_run:
      return "the node does not run the predictor that it is to publish";
    case ParamsError::negative_time:
      return "settle time and hold-back must not be negative";
    case ParamsError::hold_back_too_long:
      break;
  }
  return "the hold-back is longer than the node can hold at this filter rate: lower the rate";
}

/// Parameters of a node: the model of its sensor, and its way of learning.
template <ModelShape Shape>
struct NodeParams {
  core::NodeModel<Shape> model;
  core::Standstill::Params standstill;
  core::OdometerCheckParams odometer;
  core::EarthRate earth;                    ///< at the vehicle's latitude; zero: not known
  std::optional<core::UpAxis> up;           ///< vertical axis; none: not known
  Predictor published = Predictor::kalman;  ///< predictor that corrects the rate
  /// Whether the strength of the white noise is learnt from the calm of the stops. A model of
  /// single samples keeps its own.
  bool learns_white_noise = true;

  /// Variance of the change of the bias while the power is off; where the model has none,
  /// that of the largest bias of the chip, else of any MEMS gyro.
  [[nodiscard]] constexpr float turn_on_variance_or_widest() const {
    constexpr float kLargestOfAny_rad_s = 0.35F;  // 20 deg/s: zero-rate output of the MPU-6050
    if (core::is_finite(model.turn_on_variance_rad2_s2)) return model.turn_on_variance_rad2_s2;
    const float largest =
        core::is_finite(model.largest_bias_rad_s) ? model.largest_bias_rad_s : kLargestOfAny_rad_s;
    return largest * largest;
  }
  /// Whether a bias is larger than the chip's may be: a turn was taken for one.
  [[nodiscard]] constexpr bool is_beyond_zero_rate(float bias_rad_s) const {
    return (bias_rad_s < 0.0F ? -bias_rad_s : bias_rad_s) > model.largest_bias_rad_s;
  }
};

/// Size of a node, for boards that count bytes. The results are the same as long as nothing is
/// beyond it.
struct NodeCapacity {
  std::size_t axes = 3;             ///< measured axes, the first of a sample
  std::size_t held_ticks = 64;      ///< places of the hold-back line, 32 bytes each
  std::size_t average_levels = 22;  ///< levels of core::SuffixSums, 50 bytes each on every axis
  bool screens_samples = false;  ///< room for NodeParams::samples: 150 bytes, 8 to 12 a held tick
  bool runs_moving_average = true;    ///< 300 bytes an axis and those of average_levels
  bool runs_calibration_mean = true;  ///< 40 bytes an axis
  bool takes_references = true;       ///< filter of the references of the heading: 380 bytes

  /// Whether a node of this capacity runs a predictor. The Kalman predictor always runs: what is
  /// learnt, saved and monitored is its own.
  [[nodiscard]] constexpr bool runs(Predictor which) const {
    return which == Predictor::kalman ||
           (which == Predictor::moving_average ? runs_moving_average : runs_calibration_mean);
  }
};

/// Capacity of a TickNode of one axis that runs the Kalman predictor alone.
inline constexpr NodeCapacity kFilterAlone{.axes = 1,
                                           .runs_moving_average = false,
                                           .runs_calibration_mean = false,
                                           .takes_references = false};

/// Whether a node of this capacity can be built from these parameters.
template <ModelShape Shape>
[[nodiscard]] constexpr core::Result<void, ParamsError> check(const NodeParams<Shape>& params,
                                                              const NodeCapacity& capacity) {
  using core::Unexpected;
  constexpr core::Duration kZero;
  if (params.model.modes.tick <= kZero || params.model.sample_period <= kZero) {
    return Unexpected{ParamsError::tick_not_positive};
  }
  if (params.model.modes.tick < params.model.sample_period) {
    return Unexpected{ParamsError::tick_shorter_than_sample};
  }
  if (!core::is_measurement(0.0F, params.model.white_variance_rad2_s2)) {
    return Unexpected{ParamsError::white_variance_not_positive};
  }
  if (!capacity.screens_samples && params.model.samples.is_on()) {
    return Unexpected{ParamsError::no_room_for_samples};
  }
  if (!Shape.has_accelerometer && params.model.inputs.follows(core::is_inertial)) {
    return Unexpected{ParamsError::no_accelerometer};
  }
  if (!capacity.runs(params.published)) return Unexpected{ParamsError::predictor_not_run};
  if (params.standstill.settle < kZero || params.standstill.hold_back < kZero ||
      params.standstill.slowest < kZero) {
    return Unexpected{ParamsError::negative_time};
  }
  if (core::places_needed(params.standstill.hold_back, params.model.modes.tick) >
      static_cast<std::int64_t>(capacity.held_ticks)) {
    return Unexpected{ParamsError::hold_back_too_long};
  }
  return {};
}

}  // namespace zerorate::app
