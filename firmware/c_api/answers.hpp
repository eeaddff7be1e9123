/// @file
/// Answers of the node in the types of the C interface, and its samples in those of the node.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

#include "core/base/numeric.hpp"
#include "core/base/units.hpp"
#include "core/samples/gyro_sample.hpp"
#include "firmware/app/node_params.hpp"
#include "firmware/app/rate_message.hpp"
#include "firmware/app/resumption.hpp"
#include "firmware/c_api/include/zerorate.h"
#include "firmware/c_api/node_of_model.hpp"

namespace zerorate::c_api {

[[nodiscard]] inline zerorate_motion motion_of(core::Motion motion) {
  switch (motion) {
    case core::Motion::still:
      return ZERORATE_STILL;
    case core::Motion::settling:
      return ZERORATE_SETTLING;
    case core::Motion::moving:
      break;
  }
  return ZERORATE_MOVING;
}

[[nodiscard]] inline core::GyroSample sample_of(const zerorate_measurement& measured) {
  core::GyroSample sample{.time = core::Instant::from_ns(measured.time_ns),
                          .temperature = core::Temperature::from_degc(measured.temperature_degc),
                          .has_temperature = measured.has_temperature,
                          .saturated_axes = measured.saturated_axes};
  for (std::size_t i = 0; i < Node::kAxes; ++i) {
    sample.rate[i] = core::rad_per_s(measured.rate_rad_s[i]);
  }
  return sample;
}

inline constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Answer where nothing is known of a rate.
[[nodiscard]] inline zerorate_rate no_rate() {
  zerorate_rate rate{};
  rate.calm_percent = ZERORATE_NO_CALM;
  rate.vertical_rad_s = kNone;
  rate.heading_rad = kNone;
  rate.heading_sigma_rad = std::numeric_limits<float>::infinity();
#if ZERORATE_INPUTS > 0
  rate.vertical_turn_rad = kNone;
  rate.vertical_turn_sigma_rad = std::numeric_limits<float>::infinity();
#endif
  for (std::size_t i = 0; i < Node::kAxes; ++i) {
    rate.corrected_rad_s[i] = kNone;
    rate.bias_rad_s[i] = kNone;
    rate.sigma_rad_s[i] = std::numeric_limits<float>::infinity();
    rate.turn_rad[i] = kNone;
    rate.turn_sigma_rad[i] = std::numeric_limits<float>::infinity();
  }
  return rate;
}

[[nodiscard]] inline zerorate_health health_of(const app::Health& health) {
  return {.calibrated = health.calibrated,
          .sample_refused = health.sample_refused,
          .time_refused = health.time_refused,
          .saturated = health.saturated,
          .model_inconsistent = health.model_inconsistent,
          .odometer_fault = health.odometer_fault,
          .measurement_rejected = health.measurement_rejected,
          .temperature_missing = health.temperature_missing,
          .acceleration_missing = health.acceleration_missing,
          .odometer_disagreement = health.odometer_disagreement,
          .odometer_dead_band = health.odometer_dead_band,
          .sensor_fault = health.sensor_fault,
          .sample_rate_off = health.sample_rate_off,
          .reference_disagreement = health.reference_disagreement,
          .usable = health.is_usable()};
}
/// Fills in the answer in its place.
inline void set_rate(zerorate_rate& rate, const app::RateMessage& message) {
  const bool has_rate = message.has_rate();
  rate = {};
  rate.time_ns = message.time.ns();
  rate.motion = motion_of(message.motion);
  rate.health = health_of(message.health);
  rate.turn_time_ns = message.turn_time.ns();
  rate.vertical_rad_s =
      message.up && has_rate ? message.vertical_rate().in(core::rad_per_s) : kNone;
  rate.heading_rad = message.heading.angle.in(core::rad);
  rate.heading_sigma_rad = message.heading.sigma.in(core::rad);
  rate.calm_percent = message.calm_percent;
#if ZERORATE_INPUTS > 0
  if (message.up) std::ranges::copy(*message.up, rate.up);
  rate.vertical_turn_rad = message.vertical_turn.angle.in(core::rad);
  rate.vertical_turn_sigma_rad = message.vertical_turn.sigma.in(core::rad);
#endif
  for (std::size_t i = 0; i < Node::kAxes; ++i) {
    rate.corrected_rad_s[i] = has_rate ? message.axes[i].corrected.in(core::rad_per_s) : kNone;
    rate.bias_rad_s[i] = message.axes[i].bias.in(core::rad_per_s);
    rate.sigma_rad_s[i] = message.axes[i].sigma.in(core::rad_per_s);
    rate.turn_rad[i] = message.turn[i].angle.in(core::rad);
    rate.turn_sigma_rad[i] = message.turn[i].sigma.in(core::rad);
  }
}

[[nodiscard]] inline zerorate_result result_of(const app::Health& health) {
  if (health.time_refused) return ZERORATE_TIME_REFUSED;
  if (health.sensor_fault) return ZERORATE_SENSOR_FAULT;
  return health.sample_refused ? ZERORATE_SAMPLE_REFUSED : ZERORATE_OK;
}

[[nodiscard]] inline zerorate_result result_of(app::ParamsError error) {
  if (error == app::ParamsError::predictor_not_run) return ZERORATE_BAD_ARGUMENT;
  return ZERORATE_BAD_TIMES;
}

[[nodiscard]] inline zerorate_result result_of(app::SnapshotRefusal refusal) {
  using app::SnapshotRefusal;
  switch (refusal) {
    case SnapshotRefusal::not_a_snapshot:
      return ZERORATE_SNAPSHOT_NOT_OURS;
    case SnapshotRefusal::damaged:
    case SnapshotRefusal::impossible:
      return ZERORATE_SNAPSHOT_DAMAGED;
    case SnapshotRefusal::other_layout:
      return ZERORATE_SNAPSHOT_VERSION;
    case SnapshotRefusal::other_sensor:
      return ZERORATE_SNAPSHOT_SENSOR;
    case SnapshotRefusal::nothing_learnt:
      return ZERORATE_NOTHING_LEARNT;
    case SnapshotRefusal::turn_on_unknown:
    case SnapshotRefusal::other_model:
      break;
  }
  return ZERORATE_SNAPSHOT_NOT_USABLE;
}

#if ZERORATE_TAKES_REFERENCES
[[nodiscard]] inline zerorate_result result_of(core::ReferenceVerdict verdict) {
  switch (verdict) {
    case core::ReferenceVerdict::no_bias:
      return ZERORATE_NOTHING_LEARNT;
    case core::ReferenceVerdict::bad_time:
      return ZERORATE_REFERENCE_TIME;
    case core::ReferenceVerdict::refused:
      return ZERORATE_REFERENCE_REFUSED;
    default:
      return ZERORATE_OK;
  }
}

[[nodiscard]] inline bool is_reference(float angle_rad, float sigma_rad) {
  constexpr float kLargest_rad = 1e4F;
  constexpr float kWidest_rad = 1.6F;
  return angle_rad >= -kLargest_rad && angle_rad <= kLargest_rad && sigma_rad > 0.0F &&
         sigma_rad <= kWidest_rad;
}

[[nodiscard]] inline zerorate_figure figure_of(float value, float variance) {
  return {.value = value, .sigma = core::square_root(variance)};
}
#endif

}  // namespace zerorate::c_api
