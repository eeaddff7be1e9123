/// @file
/// Means that are too small for the zero-rate level of a gyro.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host_tools/lib/identify/rest_doubt.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::identify {

/// Remark on an axis whose mean is less than half the standard deviation of the means of tenths of
/// the recording, which must not exceed 0.05 deg/s: a larger drift may cross zero. The zero-rate
/// level of a MEMS gyro is a hundred times as large. None on an axis that is in doubt.
[[nodiscard]] std::optional<std::string> remark_on_mean(const RestSamples& samples,
                                                        std::size_t axis);

/// Axes with such a mean whose slow noise shows that more than one constant was taken out, because
/// less of it is there than of white noise; or all three axes, where slow noise is there and none
/// of them has moved away from zero. Rates that were made as white noise about zero are not among
/// them.
[[nodiscard]] std::vector<std::size_t> axes_without_bias(const RestSamples& samples);

/// One doubt for all axes where none has its bias, and one for each axis otherwise. None is
/// certain: white noise remains as it was.
[[nodiscard]] std::vector<RestDoubt> doubts_of_bias_taken_out(const RestSamples& samples);

/// doubts_of_bias_taken_out() while samples come, from means of as many of them as fit into
/// constant memory: 64 KiB an axis. Below 8192 samples each is its own mean.
class LevelCheck {
 public:
  explicit LevelCheck(std::size_t axis_count);

  void add(const std::array<float, recording::kMaxAxes>& rate_rad_s);
  [[nodiscard]] std::vector<RestDoubt> doubts() const;

 private:
  static constexpr std::size_t kMostMeans = 8192;

  void halve();

  std::vector<std::vector<double>> means_;  ///< means of each axis [rad/s]
  std::vector<double> sums_;                ///< sums of the mean that is not complete [rad/s]
  std::size_t summed_ = 0;                  ///< samples in these sums
  std::size_t together_ = 1;                ///< samples of a mean
};

}  // namespace zerorate::identify
