/// @file
/// Messages with every field set to something else.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "firmware/wire/learnt_frame.hpp"
#include "firmware/wire/rate_frame.hpp"

namespace zerorate::wire::testing {

[[nodiscard]] inline NumberedMessage random_message(std::mt19937_64& random) {
  NumberedMessage numbered{.sequence = static_cast<std::uint32_t>(random()), .message = {}};
  app::RateMessage& message = numbered.message;
  message.time = core::Instant::from_ns(static_cast<std::int64_t>(random() >> 1U));
  message.motion = static_cast<core::Motion>(random() % 3);
  for (const HealthBit& bit : kHealthBits) message.health.*bit.flag = random() % 2 == 0;
  message.calm_percent = static_cast<std::uint8_t>(random() % 256);
  std::uniform_real_distribution<float> rate(-35.0F, 35.0F);
  for (app::AxisRate& axis : message.axes) {
    axis.measured = core::rad_per_s(rate(random));
    axis.corrected = core::rad_per_s(rate(random));
    axis.bias = core::rad_per_s(rate(random));
    axis.sigma = core::rad_per_s(1e-5F * (rate(random) + 35.0F));
  }
  for (app::AxisTurn& turn : message.turn) {
    turn = {.angle = core::rad(10.0F * rate(random)), .sigma = core::rad(rate(random) + 35.0F)};
  }
  message.turn_time = core::Duration::nanoseconds(static_cast<std::int64_t>(random() >> 16U));
  message.heading = {.angle = core::rad(rate(random) / 12.0F),
                     .sigma = core::rad((rate(random) + 35.0F) / 100.0F)};
  if (random() % 4 != 0) {
    // A point on the sphere, as a figure of two angles.
    const float longitude = rate(random);
    const float latitude = rate(random);
    message.up = core::Direction{std::cos(latitude) * std::cos(longitude),
                                 std::cos(latitude) * std::sin(longitude), std::sin(latitude)};
    message.vertical_turn = {.angle = core::rad(rate(random)),
                             .sigma = core::rad((rate(random) + 35.0F) / 100.0F)};
  }
  if (random() % 4 != 0) {
    for (auto& force : message.acceleration.emplace()) force = core::m_per_s2(4.0F * rate(random));
  }
  if (random() % 4 != 0) message.slope = core::rad(rate(random));
  if (random() % 4 != 0) message.vibration = core::m_per_s2(rate(random) + 35.0F);
  if (random() % 4 != 0) {
    for (app::ExplainedBias& axis : message.explained.emplace()) {
      axis = {.temperature = core::rad_per_s(1e-3F * rate(random)),
              .acceleration = core::rad_per_s(1e-3F * rate(random)),
              .vibration = core::rad_per_s(1e-3F * rate(random))};
    }
  }
  if (random() % 4 != 0) message.temperature = core::Temperature::from_degc(rate(random));
  if (random() % 4 != 0) message.odometer_pulses = static_cast<std::uint32_t>(random());
  return numbered;
}

/// Every figure of every axis another one; axis x in round units.
[[nodiscard]] inline LearntModel some_learnt_model() {
  LearntModel learnt;
  float more = 1.0F;
  for (app::LearntNoise& axis : learnt.axes) {
    axis = {.order = {0.6F * more, 0.08F},
            .bias_instability_rad_s = {core::deg_per_h(12.0F * more).in(core::rad_per_s),
                                       core::deg_per_h(2.0F).in(core::rad_per_s)},
            .angle_random_walk_rad_per_sqrt_s = {core::deg_per_s(5e-3F * more).in(core::rad_per_s),
                                                 core::deg_per_s(1e-4F).in(core::rad_per_s)},
            .stops = 7.5F};
    more *= 1.25F;
  }
  return learnt;
}

}  // namespace zerorate::wire::testing
