/// @file
/// Whether rates look like those of a gyro at rest, in the unit that their columns name, and where
/// in a recording the sensor moved.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_tools/lib/identify/rest_doubt.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::identify {

/// Looks for a sensor that was turned, raw counts, and radians named degrees or the reverse, while
/// samples come. The limits are wider than any MEMS gyro sold: at rest none changes by 1 deg/s from
/// one half-second mean to the next beyond its white noise, none leaves its first median by
/// 15 deg/s, and none is noisier than 2 deg/s/sqrt(Hz). Linear in the samples; memory: one block of
/// them, 2 MiB.
class RestCheck {
 public:
  /// @param sample_period  the median interval  @param mean_period  of N^2 = r T, see RestSamples
  /// @param is_separated  rows in motion were left out, so that other help is offered
  RestCheck(std::size_t axis_count, core::Duration sample_period, core::Duration mean_period,
            bool is_separated = false);

  void add(core::Instant at, const std::array<float, recording::kMaxAxes>& rate_rad_s);
  /// Ends the check. Empty: no sign of motion or of a wrong unit.
  [[nodiscard]] std::vector<RestDoubt> doubts();

 private:
  /// Figures of an axis over the blocks so far.
  struct Axis {
    std::optional<double> reference_rad_s;  ///< median of the first block
    std::size_t moved = 0;                  ///< half-second means
    double furthest_rad_s = 0.0;       ///< largest distance of a mean that moved from the reference
    std::vector<double> white_sigmas;  ///< sigmas of the blocks, 1000 at most
    /// Whether all rates are whole numbers of deg/s and of rad/s, and their range.
    std::array<bool, 2> is_whole{true, true};
    double least = std::numeric_limits<double>::infinity();
    double most = -std::numeric_limits<double>::infinity();
  };

  void end_block();
  void look_at_samples(std::size_t axis);
  void look_for_motion(std::size_t axis, const std::vector<TickMean>& ticks);
  [[nodiscard]] std::optional<RestDoubt> doubt_of_counts() const;
  [[nodiscard]] std::optional<RestDoubt> doubt_of_unit() const;
  [[nodiscard]] std::optional<RestDoubt> doubt_of_motion() const;
  [[nodiscard]] std::string name(std::size_t axis) const { return block_.axis_name(axis); }

  RestSamples block_;
  bool is_separated_;
  std::array<Axis, recording::kMaxAxes> axes_;
  std::size_t ticks_ = 0;
};

/// Doubts about a complete set of samples.
[[nodiscard]] std::vector<RestDoubt> doubts_of_rest(const RestSamples& samples);

/// require_rest() of doubts_of_rest().
[[nodiscard]] std::vector<std::string> require_rest(const RestSamples& samples,
                                                    const AcceptedDoubts& accepted,
                                                    std::vector<std::size_t>& axes);

/// Samples at rest that the node's own judgement of the calm (core::CalmJudge) would not learn
/// from.
struct MotionAtRest {
  std::vector<bool> moved;  ///< one per sample
  std::size_t stops = 0;
  std::size_t stops_with_motion = 0;
  /// Magnitudes of the mean rates over half a second in motion, beyond their medians in the calm;
  /// in increasing order.
  std::vector<double> turning_rad_s;

  [[nodiscard]] double share() const;  ///< share of the samples
  /// Motion in every second stop, of three at least, is no accident.
  [[nodiscard]] bool is_usual() const {
    return stops_with_motion >= 3 && 2 * stops_with_motion >= stops;
  }
};

/// Finds motion in the samples. Linear in their number.
/// @param source  gyro: no odometer has already left out the drives
[[nodiscard]] MotionAtRest find_motion(
    const RestSamples& samples, core::StandstillSource source = core::StandstillSource::odometer);

/// Source of rest that a user names: odometer, gyro or odometer-alone. Throws std::invalid_argument
/// for another name.
[[nodiscard]] core::StandstillSource rest_source(std::string_view name);

/// Reads a recording to its end as read_rest_samples().
/// @param source  gyro: leaves out the motion that the gyro shows, whatever an odometer counts
[[nodiscard]] RestSamples read_rest(recording::Reader& reader, core::StandstillSource source,
                                    const RestOptions& options = {});

/// Keeps the calm. Where a sample is left out, the vehicle moved (RestSamples::after_drives).
void leave_out_motion(RestSamples& samples, const MotionAtRest& motion);

}  // namespace zerorate::identify
