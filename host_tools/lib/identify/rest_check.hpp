/// @file
/// Whether rates look like those of a gyro at rest, in the unit that their columns name.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::identify {

/// A reason to doubt a recording at rest.
struct RestDoubt {
  std::string sentence;    ///< with the figure that shows it, and what to do
  bool is_certain = true;  ///< results would mean nothing
};

/// Looks for a sensor that was turned, raw counts, and radians named degrees or the reverse, while
/// samples come. The limits are wider than any MEMS gyro sold: at rest none changes by 1 deg/s from
/// one half-second mean to the next beyond its white noise, none leaves its first median by
/// 15 deg/s, and none is noisier than 2 deg/s/sqrt(Hz). Linear in the samples; memory: one block of
/// them, 2 MiB.
class RestCheck {
 public:
  /// @param sample_period  the median interval  @param mean_period  of N^2 = r T, see RestSamples
  RestCheck(std::size_t axis_count, core::Duration sample_period, core::Duration mean_period);

  void add(core::Instant at, const std::array<float, recording::kMaxAxes>& rate_rad_s);
  /// Ends the check. Empty: nothing speaks against rest.
  [[nodiscard]] std::vector<RestDoubt> doubts();

 private:
  /// Figures of an axis over the blocks so far.
  struct Axis {
    std::optional<double> reference_rad_s;  ///< median of the first block
    std::size_t moved = 0;                  ///< half-second means
    double furthest_rad_s = 0.0;            ///< of the means that moved, from the reference
    std::vector<double> white_sigmas;       ///< of the blocks, 1000 at most
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
  std::array<Axis, recording::kMaxAxes> axes_;
  std::size_t ticks_ = 0;
};

/// Doubts about samples that are all there.
[[nodiscard]] std::vector<RestDoubt> doubts_of_rest(const RestSamples& samples);

/// Throws recording::DataError with the first certain doubt; returns the sentences of the others.
[[nodiscard]] std::vector<std::string> require_rest(std::vector<RestDoubt> doubts);
[[nodiscard]] std::vector<std::string> require_rest(const RestSamples& samples);

}  // namespace zerorate::identify
