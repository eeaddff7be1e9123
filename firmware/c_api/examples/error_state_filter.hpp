/// @file
/// Example: an error-state filter of a vehicle's heading that takes bias and sigma of zerorate as a
/// measurement.
#pragma once

#include <Eigen/Core>

namespace zerorate::examples {

/// Heading from a gyro, corrected by a compass or a satellite receiver's course where there is one.
/// Fixed size, single precision, no heap.
///
/// Error state: heading [rad], bias of the gyro [rad/s].
class ErrorStateFilter {
 public:
  using Covariance = Eigen::Matrix2f;

  struct Noise {
    float angle_random_walk_rad_sqrt_s = 0.0F;  ///< white noise of the gyro, N
    float bias_walk_rad_s_sqrt_s = 0.0F;  ///< random walk of the bias until it is measured again
  };

  ErrorStateFilter(const Noise& noise, float heading_rad, float sigma_rad);

  /// The gyro's raw rate about the vertical, over dt_s. A rate before the first bias is worthless:
  /// measure_bias() comes first.
  void propagate(float measured_rad_s, float dt_s);

  /// The bias as zerorate knows it: once a stop, at its end. The estimates of one stop share their
  /// errors, and a filter that took each of them for a new one would believe too much.
  void measure_bias(float bias_rad_s, float sigma_rad_s);
  /// A heading from elsewhere, within half a turn of ours; it tells of the bias too.
  void measure_heading(float heading_rad, float sigma_rad);

  [[nodiscard]] float heading_rad() const { return heading_rad_; }
  [[nodiscard]] float bias_rad_s() const { return bias_rad_s_; }
  [[nodiscard]] const Covariance& covariance() const { return covariance_; }

 private:
  void measure(const Eigen::RowVector2f& h, float residual, float variance);

  Noise noise_;
  float heading_rad_;
  float bias_rad_s_ = 0.0F;
  bool has_bias_ = false;
  Covariance covariance_;
};

}  // namespace zerorate::examples
