/// @file
/// Odometer pulses for a replay: of a made-up schedule, or from whatever columns the recording has
/// about motion.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "core/base/time.hpp"
#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/recording/row.hpp"

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

/// Gives each row of a recording its pulses: those after the row before and up to its own time.
class Odometer {
 public:
  virtual ~Odometer() = default;

  /// Appends the pulses of this row, in order. Returns whether the vehicle moves at it.
  /// @param at never decreases from row to row
  virtual bool pulses_until(core::Instant at, const recording::Row& row,
                            std::vector<core::Instant>& pulses) = 0;
};

/// The pulses of a schedule if there is one, else of the recording's odometer or still column.
/// @param sample_period the nominal one; scheduled and still-flag pulses come at least that often
/// @param is_needed false: the gyro alone decides what is rest, pulses serve the scores and may be
///   missing
/// Throws std::invalid_argument if the motion of the vehicle is needed and no column gives it.
[[nodiscard]] std::unique_ptr<Odometer> make_odometer(const recording::Columns& columns,
                                                      const std::optional<ScheduleParams>& schedule,
                                                      core::Instant start,
                                                      core::Duration sample_period,
                                                      bool is_needed = true);

}  // namespace zerorate::evaluate
