/// @file
/// Bias between measurements at rest. The model of the gyro gives its covariance, and the integral
/// of the bias over a drive is the turn that it adds to the heading.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "firmware/model/sensor_model.hpp"

namespace zerorate::diagnose {

/// Span of time [s].
struct Span {
  double from_s = 0.0;
  double to_s = 0.0;

  [[nodiscard]] double length_s() const { return to_s - from_s; }
};

/// White noise and bias of one axis. The mean of the bias is not known.
class BiasProcess {
 public:
  /// Throws std::invalid_argument for an impossible flicker noise.
  explicit BiasProcess(const model::SensorModel& model);

  /// Covariance of the integrals of the measured bias over two spans, which are the same or do not
  /// overlap [rad^2].
  [[nodiscard]] double covariance(const Span& one, const Span& other) const;

 private:
  struct Lag {
    double time_constant_s = 0.0;
    double variance_rad2_s2 = 0.0;
  };

  double white_rad2_s_ = 0.0;
  double walk_rad2_s3_ = 0.0;
  std::vector<Lag> lags_;
};

/// Prediction of the bias' integral over each drive by the integrals over spans at rest: linear, of
/// the least variance, and right for any mean of the bias.
struct BiasForecast {
  Eigen::MatrixXd weights;     ///< one row a drive, one column a span at rest
  Eigen::MatrixXd covariance;  ///< covariance of the errors, white noise of the drives included
};

/// There is at least one span at rest, and none overlaps a drive or another one.
[[nodiscard]] BiasForecast forecast_bias(const BiasProcess& process, const std::vector<Span>& rests,
                                         const std::vector<Span>& drives);

}  // namespace zerorate::diagnose
