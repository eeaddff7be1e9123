/// @file
/// Messages of a node that all is well with, for tests of what shows them.
#pragma once

#include <cstdint>

#include "host_tools/lib/live/tally.hpp"

namespace zerorate::live::testing {

[[nodiscard]] inline wire::NumberedMessage calibrated_message(std::uint32_t sequence) {
  wire::NumberedMessage numbered{.sequence = sequence, .message = {}};
  numbered.message.time = core::Instant::from_ns(1'234'000'000);
  numbered.message.motion = core::Motion::still;
  numbered.message.health.calibrated = true;
  for (app::AxisRate& axis : numbered.message.axes) {
    axis.corrected = core::deg_per_s(-0.25F);
    axis.bias = core::deg_per_s(0.5F);
    axis.sigma = core::deg_per_s(0.001F);
  }
  return numbered;
}

[[nodiscard]] inline Tally tally_of(const wire::NumberedMessage& message) {
  Tally tally;
  tally.take(message);
  return tally;
}

}  // namespace zerorate::live::testing
