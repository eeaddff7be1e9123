/// @file
/// Motion that a gyro shows in what its odometer calls rest.
#pragma once

#include <cstddef>
#include <vector>

#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::identify {

/// Samples at rest that the node's own judgement of the calm (core::CalmJudge) would not learn
/// from.
struct MotionAtRest {
  std::vector<bool> moved;  ///< one per sample
  std::size_t stops = 0;
  std::size_t stops_with_motion = 0;
  /// Magnitudes of the mean rates over half a second in motion, beyond their medians in the calm;
  /// in increasing order.
  std::vector<double> turning_rad_s;

  [[nodiscard]] double share() const;  ///< of the samples
  /// Motion in every second stop, of three at least, is no accident.
  [[nodiscard]] bool is_usual() const {
    return stops_with_motion >= 3 && 2 * stops_with_motion >= stops;
  }
};

/// Finds motion in the samples. Linear in their number.
/// @param source  gyro: no odometer has already left out the drives
[[nodiscard]] MotionAtRest find_motion(
    const RestSamples& samples, core::StandstillSource source = core::StandstillSource::odometer);

/// Reads a recording to its end as read_rest_samples().
/// @param source  gyro: leaves out the motion that the gyro shows
[[nodiscard]] RestSamples read_rest(recording::Reader& reader, core::StandstillSource source,
                                    const RestOptions& options = {});

/// Keeps the calm. Where a sample is left out, the vehicle moved (RestSamples::after_drives).
void leave_out_motion(RestSamples& samples, const MotionAtRest& motion);

}  // namespace zerorate::identify
