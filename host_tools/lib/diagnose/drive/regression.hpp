/// @file
/// Regression of the errors of drives on what may have caused them.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>

#include "host_tools/lib/diagnose/drive/drive_record.hpp"

namespace zerorate::diagnose {

/// Share of the errors by one effect: columns with free coefficients, and a share that is known.
struct Share {
  Eigen::MatrixXd columns;  ///< one row each of the record; may have no column
  Eigen::VectorXd known;    ///< [rad]
};

/// Whitened residuals of the drives, or of the windows beside them.
struct Residuals {
  double size = 0.0;     ///< number of the rows
  double squares = 0.0;  ///< sum of the squares
  double freedom = 0.0;  ///< rows less the coefficients that they determine

  /// Variance of the errors over the expected one.
  [[nodiscard]] double factor() const { return squares / freedom; }
  /// The factor, at least 1: noise and bias make their share whatever few rows show.
  [[nodiscard]] double inflation() const { return std::max(1.0, factor()); }
};

/// Coefficients at the greatest likelihood. The covariance of the errors is known but for two
/// factors of at least 1, one of the drives and one of the windows in them: a reference wanders on
/// the way.
struct DriveFit {
  Eigen::VectorXd coefficients;
  Eigen::MatrixXd covariance;  ///< covariance of the coefficients
  /// Share of the information on each coefficient that the drives have, beside the windows.
  Eigen::VectorXd share_of_drives;
  Residuals drives;
  Residuals windows;

  /// Rows and freedom that count where the drives have a share of the information.
  [[nodiscard]] double size(double share) const;
  [[nodiscard]] double freedom(double share) const;
};

/// Whitens the errors of a record once, and fits shares to them. Windows are whitened beside their
/// drives, so that they add what the drives do not show.
class DriveRegression {
 public:
  explicit DriveRegression(const DriveRecord& record);

  /// Throws nothing; columns that the earlier ones describe get coefficients of least size.
  [[nodiscard]] DriveFit fit(const Share& share) const;
  /// Gain of one fit over another with less columns: log likelihood, with the factors at their
  /// greatest likelihood [nats].
  [[nodiscard]] static double gain(const DriveFit& without, const DriveFit& with);
  /// Share of the information on the size of a known column that the drives have.
  [[nodiscard]] double share_of_drives(const Eigen::VectorXd& known, const DriveFit& fit) const;

 private:
  [[nodiscard]] Eigen::MatrixXd whitened(const Eigen::MatrixXd& columns) const;

  Eigen::Index drives_;    ///< number of the rows that are drives; windows follow
  Eigen::MatrixXd lower_;  ///< Cholesky factor of the covariance
  Eigen::VectorXd errors_;
};

/// log P of a gain as large by chance, with its sign turned [nats]: the exact law of Fisher's F.
/// @param parameters that the larger fit has more
/// @param freedom of the larger fit
/// @param size number of the rows
[[nodiscard]] double surprisal_of_drives(double gain_nats, std::size_t parameters, double freedom,
                                         double size);

}  // namespace zerorate::diagnose
