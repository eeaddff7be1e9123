/// @file
/// Stops and drives for a recording that was made at rest, so that what a node would have predicted
/// during each drive can be compared with what the sensor really did.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/base/time.hpp"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::evaluate {

/// Exponentially distributed lengths around these means.
struct ScheduleParams {
  double still_s = 60.0;
  double drive_s = 300.0;
  std::uint64_t seed = 1;
};

/// Reads "still=60,drive=300,seed=1"; what is left out keeps its default.
/// Throws std::invalid_argument that names the key and what was expected.
[[nodiscard]] ScheduleParams parse_schedule(std::string_view text);

/// Whether the vehicle moves at a time; asked for times that never decrease. Begins with a stop.
class Schedule {
 public:
  Schedule(const ScheduleParams& params, core::Instant start);

  [[nodiscard]] bool is_moving(core::Instant at);

 private:
  [[nodiscard]] core::Duration next_length();

  ScheduleParams params_;
  random::RandomStream stream_;
  std::int64_t draws_ = 0;
  core::Instant phase_end_;
  bool moving_ = false;
};

}  // namespace zerorate::evaluate
