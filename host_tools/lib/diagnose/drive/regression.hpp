/// @file
/// Regression of the errors of drives on what may have caused them.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "host_tools/lib/diagnose/drive/evidence.hpp"

namespace zerorate::diagnose {

/// Share of the errors by one effect: columns with free coefficients, and a share that is known.
struct Share {
  Eigen::MatrixXd columns;  ///< one row a drive; may have no column
  Eigen::VectorXd known;    ///< [rad]
};

/// Coefficients at the greatest likelihood. The covariance of the errors is known but for a factor.
struct DriveFit {
  Eigen::VectorXd coefficients;
  Eigen::MatrixXd covariance;  ///< covariance of the coefficients
  double residual = 0.0;       ///< sum of the squares of the whitened residuals
  double freedom = 0.0;        ///< drives less coefficients

  /// Variance of the errors over the expected one.
  [[nodiscard]] double factor() const { return residual / freedom; }
};

/// Whitens the errors of a record once, and fits shares to them.
class DriveRegression {
 public:
  explicit DriveRegression(const DriveRecord& record);

  /// Throws nothing; columns that the earlier ones describe get coefficients of least size.
  [[nodiscard]] DriveFit fit(const Share& share) const;
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(errors_.size()); }
  /// Gain of one fit over another with less columns: log likelihood, with the factor at its
  /// greatest likelihood [nats].
  [[nodiscard]] double gain(const DriveFit& without, const DriveFit& with) const;

 private:
  [[nodiscard]] Eigen::MatrixXd whitened(const Eigen::MatrixXd& columns) const;

  Eigen::MatrixXd lower_;  ///< Cholesky factor of the covariance
  Eigen::VectorXd errors_;
};

/// log P of a gain as large by chance, with its sign turned [nats]: the exact law of Fisher's F.
/// @param parameters that the larger fit has more
/// @param freedom of the larger fit
[[nodiscard]] double surprisal_of_drives(double gain_nats, std::size_t parameters, double freedom,
                                         std::size_t drives);

}  // namespace zerorate::diagnose
