// Gives the same bits whatever flags the firmware around is compiled with: before the first
// include, so that it holds for every function of this file. Fused multiply-add rounds once where
// others round twice.
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off")
#pragma GCC diagnostic ignored "-Wpsabi"  // nothing here is called by code of another compiler
#endif

#include "firmware/c_api/include/zerorate.h"
#include "firmware/c_api/include/zerorate_references.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
#include <optional>
#include <span>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"
#include "firmware/app/gyro_node.hpp"
#include "firmware/app/snapshot.hpp"
#include "firmware/c_api/answers.hpp"
#include "firmware/c_api/instance.hpp"
#include "firmware/c_api/model_checks.hpp"
#include "firmware/c_api/node_of_model.hpp"

namespace zerorate::c_api {
namespace {

static_assert(sizeof(zerorate_config::standstill) == 4 && sizeof(zerorate_rate::motion) == 4);
static_assert(ZERORATE_AXES >= 1 && ZERORATE_AXES <= 3);
static_assert(ZERORATE_DECAYING_MODES >= 1 && ZERORATE_ROTATING_MODES >= 0);
static_assert(Snapshot::kBytesOfFilters == ZERORATE_SNAPSHOT_BYTES);
static_assert(Node::kAxes == ZERORATE_AXES);
static_assert(app::RateMessage::kNoCalm == ZERORATE_NO_CALM);
static_assert(RestWord::kNoLimit == core::Duration::nanoseconds(ZERORATE_SILENCE_IS_REST));

/// False where a cast made the storage of memory that a processor cannot read as one.
bool is_aligned(const zerorate_node* storage) {
  return reinterpret_cast<std::uintptr_t>(storage) % alignof(zerorate_node) == 0;
}

/// Null where the storage holds no instance.
const Instance* instance_in(const zerorate_node* storage) {
  if (storage == nullptr || !is_aligned(storage)) return nullptr;
  const auto* instance = std::launder(reinterpret_cast<const Instance*>(storage));
  return instance->is_here() ? instance : nullptr;
}
Instance* instance_in(zerorate_node* storage) {
  const Instance* instance = instance_in(static_cast<const zerorate_node*>(storage));
  return instance != nullptr ? std::launder(reinterpret_cast<Instance*>(storage)) : nullptr;
}

bool is_time(std::int64_t ns) {
  return core::is_in_range(core::Instant::from_ns(ns));
}

app::SnapshotTime snapshot_time(std::int64_t utc_s) {
  app::SnapshotTime time;
  if (utc_s != ZERORATE_NO_CLOCK) time.utc_s = utc_s;
  return time;
}

}  // namespace
}  // namespace zerorate::c_api

// The language of the interface is C.
// NOLINTBEGIN(readability-identifier-naming)
using namespace zerorate;
using c_api::instance_in;

namespace {

/// Hands a stamp over, and says where its clock went back.
template <class HandOver>
zerorate_result stamp(zerorate_node* self, std::int64_t time_ns, HandOver hand_over) {
  auto* instance = instance_in(self);
  if (instance == nullptr) return ZERORATE_NOT_INITIALISED;
  if (!c_api::is_time(time_ns)) return ZERORATE_BAD_ARGUMENT;
  const core::Instant at = core::Instant::from_ns(time_ns);
  hand_over(*instance, at);
  return instance->is_far_back(at) ? ZERORATE_CLOCK_WENT_BACK : ZERORATE_OK;
}

zerorate_result take_sample(c_api::Instance& instance, const zerorate_measurement& measured,
                            zerorate_rate& rate) {
  const core::GyroSample sample = c_api::sample_of(measured);
  const bool went_back = instance.is_far_back(sample.time);
  const app::RateMessage message = instance.take(sample);
  c_api::set_rate(rate, message);
  if (went_back) return ZERORATE_CLOCK_WENT_BACK;
  return c_api::result_of(message.health);
}

}  // namespace

zerorate_config zerorate_default_config() {
  const core::Standstill::Params standstill;
  return {.settle_ns = standstill.settle.ns(),
          .hold_back_ns = standstill.hold_back.ns(),
          .word_timeout_ns = core::Duration::seconds(1).ns(),
          .odometer_latency_ns = 0,
          .odometer_dead_band_mps = 0.0F,
          .count_rad_s = 0.0F,
          .predictor = ZERORATE_KALMAN,
          .sensor_id = 0,
          .standstill = ZERORATE_BY_ODOMETER,
          .up_axis = 0,
          .latitude_deg = 0.0F};
}

zerorate_result zerorate_init(zerorate_node* self, const zerorate_model* model,
                              const zerorate_config* config) {
  if (self == nullptr || model == nullptr || !c_api::is_aligned(self)) return ZERORATE_BAD_ARGUMENT;
  *self = {};
  if (!c_api::is_sound(*model)) return ZERORATE_BAD_MODEL;
  const zerorate_config chosen = config != nullptr ? *config : zerorate_default_config();
  if (!c_api::are_sound_times(*model, chosen)) return ZERORATE_BAD_TIMES;
  if (!c_api::is_sound(chosen)) return ZERORATE_BAD_ARGUMENT;
  const c_api::Node::Params params = c_api::params_of(*model, chosen);
  if (const auto checked = c_api::Node::check(params); !checked) {
    return c_api::result_of(checked.error());
  }
  new (self) c_api::Instance{params, chosen};
  return ZERORATE_OK;
}

zerorate_result zerorate_pulse(zerorate_node* self, int64_t time_ns) {
  return stamp(self, time_ns, [](auto& instance, core::Instant at) { instance.pulse(at); });
}

zerorate_result zerorate_report_odometer_fault(zerorate_node* self, int64_t now_ns) {
  return stamp(self, now_ns,
               [](auto& instance, core::Instant now) { instance.report_odometer_fault(now); });
}

zerorate_result zerorate_zero_velocity(zerorate_node* self, int64_t time_ns, bool stands) {
  return stamp(self, time_ns, [=](auto& instance, core::Instant at) { instance.hear(at, stands); });
}

zerorate_result zerorate_acceleration(zerorate_node* self, int64_t time_ns,
                                      const float acceleration_m_s2[3]) {
  if (acceleration_m_s2 == nullptr || ZERORATE_INPUTS == 0) return ZERORATE_BAD_ARGUMENT;
  const std::span<const float, 3> given{acceleration_m_s2, 3};
  std::array<core::Acceleration, 3> acceleration;
  for (std::size_t i = 0; i < acceleration.size(); ++i) {
    acceleration[i] = core::m_per_s2(given[i]);
    if (!core::Accelerometer::is_reading(acceleration[i].in(core::standard_gravity))) {
      return ZERORATE_SAMPLE_REFUSED;
    }
  }
  return stamp(self, time_ns, [&](c_api::Instance& instance, core::Instant at) {
    instance.node().take_acceleration(at, acceleration);
  });
}

zerorate_result zerorate_sample(zerorate_node* self, const zerorate_measurement* measured,
                                zerorate_rate* rate) {
  if (rate == nullptr) return ZERORATE_BAD_ARGUMENT;
  auto* instance = measured != nullptr ? instance_in(self) : nullptr;
  if (instance != nullptr && c_api::is_sound(*measured)) {
    return take_sample(*instance, *measured, *rate);
  }
  *rate = c_api::no_rate();
  return measured != nullptr && instance == nullptr ? ZERORATE_NOT_INITIALISED
                                                    : ZERORATE_BAD_ARGUMENT;
}

zerorate_result zerorate_predict_heading(const zerorate_node* self, uint8_t axis, uint32_t samples,
                                         zerorate_heading_error* error) {
  if (axis >= c_api::Node::kAxes || samples == 0 || error == nullptr) return ZERORATE_BAD_ARGUMENT;
  const auto* instance = instance_in(self);
  if (instance == nullptr) return ZERORATE_NOT_INITIALISED;
  const auto& params = instance->node().params();
  const core::Instant from = instance->node().newest_sample();
  if (samples > (core::kLatestTime - from) / params.model.sample_period)
    return ZERORATE_BAD_ARGUMENT;
  const auto heading = instance->node().predict_heading(
      params.published, axis, from, from + params.model.sample_period * std::int64_t{samples});
  if (!heading.is_available()) return ZERORATE_NOTHING_LEARNT;
  *error = {.angle_rad = heading.angle_rad, .sigma_rad = heading.sigma_rad()};
  return ZERORATE_OK;
}

#if ZERORATE_TAKES_REFERENCES
zerorate_result zerorate_heading_reference(zerorate_node* self, int64_t time_ns, float heading_rad,
                                           float sigma_rad) {
  auto* instance = instance_in(self);
  if (instance == nullptr) return ZERORATE_NOT_INITIALISED;
  if (!instance->node().has_vertical() || !c_api::is_time(time_ns) ||
      !c_api::is_reference(heading_rad, sigma_rad)) {
    return ZERORATE_BAD_ARGUMENT;
  }
  return c_api::result_of(
      instance->node().take_reference(app::HeadingReference{.time = core::Instant::from_ns(time_ns),
                                                            .heading = core::rad(heading_rad),
                                                            .sigma = core::rad(sigma_rad)}));
}

zerorate_result zerorate_turn_reference(zerorate_node* self, int64_t from_ns, int64_t to_ns,
                                        float angle_rad, float sigma_rad) {
  auto* instance = instance_in(self);
  if (instance == nullptr) return ZERORATE_NOT_INITIALISED;
  if (!instance->node().has_vertical() || !c_api::is_time(from_ns) || !c_api::is_time(to_ns) ||
      from_ns >= to_ns || !c_api::is_reference(angle_rad, sigma_rad)) {
    return ZERORATE_BAD_ARGUMENT;
  }
  return c_api::result_of(
      instance->node().take_reference(app::TurnReference{.from = core::Instant::from_ns(from_ns),
                                                         .to = core::Instant::from_ns(to_ns),
                                                         .angle = core::rad(angle_rad),
                                                         .sigma = core::rad(sigma_rad)}));
}

zerorate_result zerorate_get_learnt_motion(const zerorate_node* self,
                                           zerorate_learnt_motion* learnt) {
  if (learnt == nullptr) return ZERORATE_BAD_ARGUMENT;
  const auto* instance = instance_in(self);
  if (instance == nullptr) return ZERORATE_NOT_INITIALISED;
  if (!instance->node().has_vertical()) return ZERORATE_BAD_ARGUMENT;
  const core::HeadingFilter& filter = instance->node().heading_filter();
  const app::Heading heading = instance->node().heading();
  *learnt = {
      .heading_rad = {.value = heading.angle.in(core::rad), .sigma = heading.sigma.in(core::rad)},
      .scale_factor_error = c_api::figure_of(filter.scale_factor(), filter.scale_factor_variance()),
      .offset_rad_s = c_api::figure_of(filter.offset_rad_s(), filter.offset_variance_rad2_s2()),
      .quality = filter.quality(),
      .references = filter.state().lessons.references,
      .drives = filter.state().lessons.drives};
  return ZERORATE_OK;
}
#endif

zerorate_result zerorate_get_learnt_noise(const zerorate_node* self, uint8_t axis,
                                          zerorate_learnt_noise* learnt) {
  if (axis >= c_api::Node::kAxes || learnt == nullptr) return ZERORATE_BAD_ARGUMENT;
  const auto* instance = instance_in(self);
  if (instance == nullptr) return ZERORATE_NOT_INITIALISED;
  const app::LearntNoise noise = instance->node().predictors().learnt_noise(axis);
  const auto figure = [](const app::LearntFigure& one) {
    return zerorate_figure{.value = one.value, .sigma = one.sigma};
  };
  *learnt = {.order = figure(noise.order),
             .bias_instability_rad_s = figure(noise.bias_instability_rad_s),
             .angle_random_walk_rad_per_sqrt_s = figure(noise.angle_random_walk_rad_per_sqrt_s),
             .stops = noise.stops};
  return ZERORATE_OK;
}

zerorate_result zerorate_save(zerorate_node* self, int64_t utc_s, uint8_t* record,
                              size_t capacity) {
  if (record == nullptr) return ZERORATE_BAD_ARGUMENT;
  auto* instance = instance_in(self);
  if (instance == nullptr) return ZERORATE_NOT_INITIALISED;
  constexpr std::size_t kBytes = c_api::Snapshot::kBytesOfFilters;
  if (capacity < kBytes) return ZERORATE_BUFFER_TOO_SMALL;
  if (!instance->node().predictors().has_learnt()) return ZERORATE_NOTHING_LEARNT;
  instance->snapshot().write_filters(instance->node(), c_api::snapshot_time(utc_s),
                                     std::span<std::uint8_t, kBytes>{record, kBytes});
  return ZERORATE_OK;
}

zerorate_result zerorate_restore(zerorate_node* self, int64_t utc_s, const uint8_t* record,
                                 size_t size) {
  if (record == nullptr) return ZERORATE_BAD_ARGUMENT;
  auto* instance = instance_in(self);
  if (instance == nullptr) return ZERORATE_NOT_INITIALISED;
  if (instance->node().has_sample()) return ZERORATE_TOO_LATE;
  const auto resumed = instance->snapshot().restore_filters(
      instance->node(), std::span{record, size}, c_api::snapshot_time(utc_s));
  if (!resumed) return c_api::result_of(resumed.error());
  return ZERORATE_OK;
}
// NOLINTEND(readability-identifier-naming)
