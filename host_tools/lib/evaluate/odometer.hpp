/// @file
/// Odometer pulses for a replay, from whatever the recording tells about motion.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/base/time.hpp"
#include "host_tools/lib/evaluate/schedule.hpp"
#include "host_tools/lib/recording/row.hpp"

namespace zerorate::evaluate {

/// Gives each row of a recording its pulses: those after the row before and up to its own time.
class Odometer {
 public:
  virtual ~Odometer() = default;

  /// Appends the pulses of this row, in order, and says whether the vehicle moves at it.
  /// @param at never decreases from row to row
  virtual bool pulses_until(core::Instant at, const recording::Row& row,
                            std::vector<core::Instant>& pulses) = 0;
};

/// The pulses of a schedule if there is one, else of the recording's odometer or still column.
/// @param sample_period the nominal one; scheduled and still-flag pulses come at least that often
/// @param is_needed false: the gyro alone tells rest, pulses serve the scores and may be missing
/// Throws std::invalid_argument if nothing tells when the vehicle moves, and it is needed.
[[nodiscard]] std::unique_ptr<Odometer> make_odometer(const recording::Columns& columns,
                                                      const std::optional<ScheduleParams>& schedule,
                                                      core::Instant start,
                                                      core::Duration sample_period,
                                                      bool is_needed = true);

}  // namespace zerorate::evaluate
