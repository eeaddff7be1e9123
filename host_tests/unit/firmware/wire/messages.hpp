/// @file
/// Messages with every field set to something else.
#pragma once

#include <cstdint>
#include <random>

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
  return numbered;
}

}  // namespace zerorate::wire::testing
