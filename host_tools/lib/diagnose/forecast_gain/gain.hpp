/// @file
/// Gain of an extension on data that it was not fitted to (docs/design/diagnosis.md,
/// section 8).
#pragma once

#include <cstdint>

#include "host_tools/lib/diagnose/record/record.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

/// Runs both models through the node's filter. It learns from everything up to the last part of the
/// record; there stops and drives alternate, and what it had predicted of each drive is compared
/// with what was measured. Intervals by resampling blocks of drives (Künsch 1989), in pairs.
/// Throws ModelCannotRun.
/// @param base, extended fitted to the first part
/// @param holdout share of the record at its end, in (0, 1)
[[nodiscard]] Gain measure_gain(const Record& record, const model::SensorModel& base,
                                const model::SensorModel& extended, double holdout,
                                std::uint64_t seed);

}  // namespace zerorate::diagnose
