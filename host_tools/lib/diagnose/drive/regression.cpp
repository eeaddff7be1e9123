#include "host_tools/lib/diagnose/drive/regression.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>

#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::diagnose {

DriveRegression::DriveRegression(const DriveRecord& record)
    : lower_(record.covariance().llt().matrixL()), errors_(whitened(record.errors())) {}

Eigen::MatrixXd DriveRegression::whitened(const Eigen::MatrixXd& columns) const {
  return lower_.triangularView<Eigen::Lower>().solve(columns);
}

DriveFit DriveRegression::fit(const Share& share) const {
  const Eigen::VectorXd y = errors_ - Eigen::VectorXd(whitened(share.known));
  DriveFit fit{.residual = y.squaredNorm(), .freedom = static_cast<double>(size())};
  if (share.columns.cols() == 0) return fit;
  const Eigen::MatrixXd x = whitened(share.columns);
  const Eigen::MatrixXd inverse =
      (x.transpose() * x).completeOrthogonalDecomposition().pseudoInverse();
  fit.coefficients = inverse * (x.transpose() * y);
  fit.residual = (y - x * fit.coefficients).squaredNorm();
  fit.freedom -= static_cast<double>(x.cols());
  fit.covariance = inverse * fit.factor();
  return fit;
}

double DriveRegression::gain(const DriveFit& without, const DriveFit& with) const {
  return 0.5 * static_cast<double>(size()) * std::log(without.residual / with.residual);
}

double surprisal_of_drives(double gain_nats, std::size_t parameters, double freedom,
                           std::size_t drives) {
  if (!(gain_nats > 0.0) || !(freedom > 0.0)) return 0.0;
  // The share of the residual that is left has the law of beta(freedom / 2, parameters / 2).
  const double left = std::exp(-2.0 * gain_nats / static_cast<double>(drives));
  if (parameters == 1) {
    const double t = std::sqrt(freedom * (1.0 - left) / left);
    return -std::log(2.0) - statistics::log_student_tail(t, freedom);
  }
  // Integral of the density of beta over the shares below: by its series, whose terms are positive.
  const double a = 0.5 * freedom;
  const double b = 0.5 * static_cast<double>(parameters);
  double term = 1.0 / a;
  double sum = term;
  for (int k = 1; k < 4000 && term > 1e-14 * sum; ++k) {
    term *= left * (a + b + k - 1.0) / (a + k);
    sum += term;
  }
  const double log_beta = std::lgamma(a) + std::lgamma(b) - std::lgamma(a + b);
  return -(a * std::log(left) + b * std::log1p(-left) + std::log(sum) - log_beta);
}

}  // namespace zerorate::diagnose
