/// @file
/// Noise model of a sensor in the figures that a node computes with.
#pragma once

#include <limits>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "core/estimator/gate.hpp"
#include "core/heading/turn_sum.hpp"
#include "core/noise/hypotheses.hpp"
#include "core/noise/inputs.hpp"
#include "core/noise/model_shape.hpp"
#include "core/samples/rounding_watch.hpp"
#include "core/samples/sample_model.hpp"
#include "core/samples/scale_correction.hpp"
#include "core/samples/truncation.hpp"

namespace zerorate::core {

/// Noise of each axis of a sensor at the filter's tick. Made by model::make_node_model() or
/// exported by `zerorate export`.
template <ModelShape Shape>
struct NodeModel {
  ModesOf<Shape> modes;                             ///< slow noise at the filter's tick
  float white_variance_rad2_s2 = 0.0F;              ///< white variance of one sample
  float measurement_floor_variance_rad2_s2 = 0.0F;  ///< variance that averaging does not remove
  /// Variance of the change of the bias while the power is off; infinite: unknown, and nothing is
  /// worth keeping.
  float turn_on_variance_rad2_s2 = std::numeric_limits<float>::infinity();
  /// Largest magnitude of a bias by the chip's specification. A larger one is learnt and flagged.
  float largest_bias_rad_s = std::numeric_limits<float>::infinity();
  Gate gate;  ///< gate of the Kalman predictor; off by default
  /// Inputs that the bias follows, as the Kalman predictor starts; off by default.
  [[no_unique_address]] InputBlock<Shape.inputs> inputs{};
  SampleModel samples{};    ///< model of single samples; off by default
  MotionModel motion{};     ///< errors that rest does not show
  ScaleCorrection scale{};  ///< known errors of the scale factors; off by default
  Duration sample_period;   ///< nominal; the stamps of the samples decide
  /// Slow noises that the sensor may have; none: the model is taken at its word.
  [[no_unique_address]] HypothesesOf<Shape> hypotheses{};
  /// Step that samples are rounded to. The filter treats the rounding error as noise, and the two
  /// variances above contain it.
  float quantization_step_rad_s = 0.0F;
  Truncation truncation{};  ///< samples that are cut toward zero; off by default

  constexpr bool operator==(const NodeModel&) const = default;
  [[nodiscard]] constexpr Rounding rounding() const {
    return {.step_rad_s = quantization_step_rad_s,
            .floor_rad2_s2 = measurement_floor_variance_rad2_s2,
            .is_truncation = truncation.is_on()};
  }
  /// Rates without the known errors of the chip: truncation first, then the scale factors.
  /// @param measured  rates of x, y and z
  [[nodiscard]] constexpr ScaleCorrection::Rates corrected(
      const ScaleCorrection::Rates& measured) const {
    if (!truncation.is_on()) return scale.corrected(measured);
    return scale.corrected(truncation.undone(measured));
  }
  [[nodiscard]] constexpr AngularRate corrected(AngularRate measured, std::size_t axis) const {
    return scale.corrected(truncation.undone(measured), axis);
  }
  /// Variance of the mean of `count` samples.
  [[nodiscard]] constexpr float measurement_variance(float count) const {
    return white_variance_rad2_s2 / count + measurement_floor_variance_rad2_s2;
  }
};

}  // namespace zerorate::core
