/// @file
/// The health of a message as bits, the same on every wire.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "firmware/app/rate_message.hpp"

namespace zerorate::wire {

/// Bit i, under the name that JSON, metrics and the DBC file use.
struct HealthBit {
  std::string_view name;
  bool app::Health::*flag;
};

/// New bits are appended; a bit never changes its meaning.
inline constexpr std::array<HealthBit, 14> kHealthBits{{
    {"calibrated", &app::Health::calibrated},
    {"sample_refused", &app::Health::sample_refused},
    {"time_refused", &app::Health::time_refused},
    {"saturated", &app::Health::saturated},
    {"model_inconsistent", &app::Health::model_inconsistent},
    {"odometer_fault", &app::Health::odometer_fault},
    {"sensor_fault", &app::Health::sensor_fault},
    {"measurement_rejected", &app::Health::measurement_rejected},
    {"temperature_missing", &app::Health::temperature_missing},
    {"odometer_disagreement", &app::Health::odometer_disagreement},
    {"odometer_dead_band", &app::Health::odometer_dead_band},
    {"sample_rate_off", &app::Health::sample_rate_off},
    {"reference_disagreement", &app::Health::reference_disagreement},
    {"acceleration_missing", &app::Health::acceleration_missing},
}};

[[nodiscard]] constexpr std::uint16_t encode_health(const app::Health& health) {
  unsigned bits = 0;
  for (std::size_t i = 0; i < kHealthBits.size(); ++i) {
    if (health.*kHealthBits[i].flag) bits |= 1U << i;
  }
  return static_cast<std::uint16_t>(bits);
}

/// Bits that this version does not know are ignored.
[[nodiscard]] constexpr app::Health decode_health(std::uint16_t encoded) {
  const unsigned bits = encoded;
  app::Health health;
  for (std::size_t i = 0; i < kHealthBits.size(); ++i) {
    health.*kHealthBits[i].flag = ((bits >> i) & 1U) != 0;
  }
  return health;
}

}  // namespace zerorate::wire
