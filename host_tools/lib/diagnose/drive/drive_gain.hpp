/// @file
/// Worth of causes on drives that they were not fitted to.
#pragma once

#include <optional>
#include <vector>

#include "host_tools/lib/diagnose/drive/drive_selection.hpp"
#include "host_tools/lib/diagnose/result/drive_diagnosis.hpp"

namespace zerorate::diagnose {

/// Fits to the first two thirds and scores the last third, or with fewer than twelve drives leaves
/// one out at a time. Intervals are by drawing the drives held out.
/// @param tolerance of the scale factor, relative, in the interval before
[[nodiscard]] DriveGain measure_drive_gain(const DriveRecord& record,
                                           const std::vector<MotionChoice>& choices,
                                           double tolerance);

/// Heading error with all causes over that without one of them, on the same drives.
[[nodiscard]] BootstrapFigure drift_ratio_of(const DriveRecord& record,
                                             const std::vector<MotionChoice>& choices,
                                             std::size_t cause);

}  // namespace zerorate::diagnose
