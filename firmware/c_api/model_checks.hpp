/// @file
/// Whether what a caller hands over in C can be a model, a configuration or a measurement.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"
#include "firmware/c_api/include/zerorate.h"

namespace zerorate::c_api {

/// Largest magnitude accepted for a model parameter (SI units, times excepted): no sum of squares
/// of such parameters overflows single precision. NaN fails every comparison.
inline constexpr float kLargestFigure = 1e6F;
[[nodiscard]] inline bool is_figure(float value) {
  return value >= -kLargestFigure && value <= kLargestFigure;
}
[[nodiscard]] inline bool is_magnitude(float value) {
  return value >= 0.0F && value <= kLargestFigure;
}

[[nodiscard]] inline bool does_something(const auto& mode) {
  return mode.noise_variance > 0.0F || mode.initial_variance > 0.0F || mode.initial_mean != 0.0F;
}

[[nodiscard]] inline bool is_sound(const zerorate_decaying_mode& mode) {
  const bool decays = mode.one_minus_phi > 0.0F && mode.one_minus_phi <= 1.0F;
  return (decays || !does_something(mode)) && is_magnitude(mode.noise_variance) &&
         is_magnitude(mode.initial_variance) && is_figure(mode.initial_mean);
}
[[nodiscard]] inline bool is_sound(const zerorate_rotating_mode& mode) {
  const float remaining_re = 1.0F - mode.one_minus_phi.re;
  const float remaining_im = mode.one_minus_phi.im;
  return remaining_re * remaining_re + remaining_im * remaining_im <= 1.0F &&
         is_magnitude(mode.noise_variance) && is_magnitude(mode.initial_variance) &&
         is_figure(mode.initial_mean);
}
/// Largest magnitude of a temperature coefficient: the square of hundreds of kelvin multiplies it.
inline constexpr float kLargestDrift = 1e3F;
[[nodiscard]] inline bool is_drift(float value) {
  return value >= -kLargestDrift && value <= kLargestDrift;
}
[[nodiscard]] inline bool is_sound(const zerorate_temperature_drift& drift) {
  return is_drift(drift.reference_degc) && is_drift(drift.slope_rad_s_per_k) &&
         is_drift(drift.slope_sigma_rad_s_per_k) && drift.slope_sigma_rad_s_per_k >= 0.0F &&
         is_drift(drift.curvature_rad_s_per_k2) && is_drift(drift.curvature_sigma_rad_s_per_k2) &&
         drift.curvature_sigma_rad_s_per_k2 >= 0.0F && is_magnitude(drift.lag_s);
}
/// Largest strength of a mode: the slowest lag of a random walk over that of a flicker.
inline constexpr float kLargestStrength = 1e8F;
[[nodiscard]] inline bool is_strength(float value) {
  return value >= 0.0F && value <= kLargestStrength;
}
[[nodiscard]] inline bool is_sound(const zerorate_hypothesis& hypothesis) {
  return std::ranges::all_of(hypothesis.strength, is_strength) && is_figure(hypothesis.log_prior) &&
         is_magnitude(hypothesis.level) && is_magnitude(hypothesis.order) &&
         is_magnitude(hypothesis.bias_instability_rad_s) &&
         is_magnitude(hypothesis.angle_random_walk_rad_per_sqrt_s);
}
[[nodiscard]] inline bool are_sound_hypotheses(const zerorate_model& model) {
  if (model.hypothesis_count == 0) return true;
  return ZERORATE_HYPOTHESES > 1 && model.hypothesis_count <= ZERORATE_HYPOTHESES &&
         model.evidence_kept > 0.0F && model.evidence_kept <= 1.0F &&
         std::ranges::all_of(model.hypotheses, [](const auto& one) { return is_sound(one); });
}
[[nodiscard]] inline bool is_tolerance(float value) {
  constexpr float kLargestTolerance = 0.2F;
  return value >= 0.0F && value <= kLargestTolerance;
}
[[nodiscard]] inline bool is_temperature_k(float value) {
  constexpr float kHottest_k = 500.0F;
  return value >= 0.0F && value <= kHottest_k;
}
[[nodiscard]] inline bool is_scale_error(float value) {
  constexpr float kLargestError = 0.2F;
  return value > -kLargestError && value < kLargestError;
}
/// A model that follows the temperature is refused by a library that does not.
[[nodiscard]] inline bool is_followed(const zerorate_temperature_drift& drift) {
  return ZERORATE_TEMPERATURE != 0 ||
         (drift.slope_rad_s_per_k == 0.0F && drift.slope_sigma_rad_s_per_k == 0.0F &&
          drift.curvature_rad_s_per_k2 == 0.0F && drift.curvature_sigma_rad_s_per_k2 == 0.0F);
}
#if ZERORATE_INPUTS > 0
[[nodiscard]] inline bool are_sound_inputs(const zerorate_model& model) {
  unsigned seen = 0;
  for (const zerorate_input& input : model.inputs) {
    if (input.quantity < ZERORATE_NO_QUANTITY || input.quantity > ZERORATE_TEMPERATURE_RATE ||
        !is_drift(input.sigma) || input.sigma < 0.0F ||
        !std::ranges::all_of(input.coefficient, is_drift)) {
      return false;
    }
    const unsigned bit = 1U << static_cast<unsigned>(input.quantity);
    if (input.quantity != ZERORATE_NO_QUANTITY && (seen & bit) != 0) return false;
    seen |= bit;
  }
  return true;
}
#else
[[nodiscard]] inline bool are_sound_inputs(const zerorate_model& /*model*/) {
  return true;
}
#endif
[[nodiscard]] inline bool are_sound_modes(const zerorate_model& model) {
  const auto sound = [](const auto& mode) { return is_sound(mode); };
#if ZERORATE_ROTATING_MODES > 0
  if (!std::ranges::all_of(model.rotating, sound)) return false;
#endif
  return std::ranges::all_of(model.decaying, sound);
}
[[nodiscard]] inline bool is_sound(const zerorate_model& model) {
  return are_sound_modes(model) && is_followed(model.temperature) &&
         is_magnitude(model.walk_variance_rad2_s2) && is_magnitude(model.white_variance_rad2_s2) &&
         core::is_finite_positive(model.white_variance_rad2_s2) &&
         is_magnitude(model.measurement_floor_variance_rad2_s2) &&
         (is_magnitude(model.turn_on_variance_rad2_s2) ||
          model.turn_on_variance_rad2_s2 == ZERORATE_UNKNOWN_VARIANCE) &&
         is_tolerance(model.scale_factor_sigma) && is_tolerance(model.asymmetry_sigma) &&
         is_magnitude(model.slope_variance_rad2) && is_tolerance(model.scale_factor_sigma_per_k) &&
         is_temperature_k(model.scale_factor_at_k) &&
         std::ranges::all_of(model.scale_factor_error, is_scale_error) &&
         is_magnitude(model.truncation_step_rad_s) && is_magnitude(model.largest_bias_rad_s) &&
         is_magnitude(model.gate_threshold_sigma) && is_sound(model.temperature) &&
         are_sound_inputs(model) && are_sound_hypotheses(model);
}

inline constexpr std::int64_t kLongest_ns = core::Duration::seconds(3600).ns();
/// Silence counts for ever, or a word for a time: none at all would be forgotten rather than meant.
[[nodiscard]] inline bool is_sound_timeout(std::int64_t timeout_ns) {
  return timeout_ns == ZERORATE_SILENCE_IS_REST || (timeout_ns > 0 && timeout_ns <= kLongest_ns);
}
/// Upper limits of the others: the node checks that times are positive and fit each other.
[[nodiscard]] inline bool are_sound_times(const zerorate_model& model,
                                          const zerorate_config& config) {
  return std::max({model.sample_period_ns, model.tick_ns, config.settle_ns, config.hold_back_ns,
                   config.odometer_latency_ns}) <= kLongest_ns &&
         config.hold_back_ns >= 0 && config.odometer_latency_ns >= 0 &&
         is_sound_timeout(config.word_timeout_ns);
}

/// Enumerations of C hold any number.
[[nodiscard]] inline bool are_sound_choices(const zerorate_config& config) {
  return config.predictor >= ZERORATE_KALMAN && config.predictor <= ZERORATE_CALIBRATION_MEAN &&
         config.standstill >= ZERORATE_BY_ODOMETER && config.standstill <= ZERORATE_BY_WORD;
}
[[nodiscard]] inline bool is_sound_place(const zerorate_config& config) {
  constexpr float kPole_deg = 90.0F;
  return config.up_axis >= -ZERORATE_AXES && config.up_axis <= ZERORATE_AXES &&
         ((config.up_axis == 0 && ZERORATE_INPUTS == 0) ||
          (config.latitude_deg >= -kPole_deg && config.latitude_deg <= kPole_deg));
}
[[nodiscard]] inline bool is_sound(const zerorate_config& config) {
  constexpr float kFastestDeadBand_mps = 10.0F;
  return are_sound_choices(config) && is_sound_place(config) &&
         config.odometer_dead_band_mps >= 0.0F &&
         config.odometer_dead_band_mps <= kFastestDeadBand_mps && is_magnitude(config.count_rad_s);
}

/// Time and mask alone: the node flags rates that cannot be.
[[nodiscard]] inline bool is_sound(const zerorate_measurement& measured) {
  return core::is_in_range(core::Instant::from_ns(measured.time_ns)) &&
         (measured.saturated_axes >> ZERORATE_AXES) == 0;
}

}  // namespace zerorate::c_api
