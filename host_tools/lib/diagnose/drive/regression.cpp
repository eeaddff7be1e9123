#include "host_tools/lib/diagnose/drive/regression.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::diagnose {

namespace {

Residuals residuals_of(const Eigen::VectorXd& rows) {
  return {.size = static_cast<double>(rows.size()), .squares = rows.squaredNorm()};
}

/// Residuals of a fit without coefficients.
Residuals all_left(const Eigen::VectorXd& rows) {
  Residuals residuals = residuals_of(rows);
  residuals.freedom = residuals.size;
  return residuals;
}

/// Likeliest weight of a block of rows whose variance is no less than expected.
double weight_of(const Residuals& rows) {
  return rows.size > 0.0 ? std::min(1.0, rows.size / rows.squares) : 0.0;
}

/// Log likelihood of a block of rows at its likeliest weight, but for a constant.
double log_likelihood(const Residuals& rows) {
  const double weight = weight_of(rows);
  return rows.size > 0.0 ? 0.5 * (rows.size * std::log(weight) - weight * rows.squares) : 0.0;
}

Eigen::MatrixXd squares_of(const Eigen::MatrixXd& rows) {
  return rows.transpose() * rows;
}

/// Information of drives and windows on the coefficients, the factors of their variances left out.
struct Information {
  Eigen::MatrixXd drives;
  Eigen::MatrixXd windows;

  /// Covariance of the coefficients at some weights.
  [[nodiscard]] Eigen::MatrixXd inverse(double of_drives, double of_windows) const {
    const Eigen::MatrixXd both = of_drives * drives + of_windows * windows;
    return both.completeOrthogonalDecomposition().pseudoInverse();
  }
};

/// Freedom of a mean of two estimates by the rule of Welch and Satterthwaite.
double pooled(double share, double by_drives, double by_windows) {
  if (!(by_windows > 0.0)) return by_drives;
  return 1.0 / (share * share / by_drives + (1.0 - share) * (1.0 - share) / by_windows);
}

}  // namespace

double DriveFit::size(double share) const {
  return pooled(share, drives.size, windows.size);
}

double DriveFit::freedom(double share) const {
  return pooled(share, drives.freedom, windows.freedom);
}

DriveRegression::DriveRegression(const DriveRecord& record)
    : drives_(static_cast<Eigen::Index>(record.size())),
      lower_(record.covariance().llt().matrixL()),
      errors_(whitened(record.errors())) {}

Eigen::MatrixXd DriveRegression::whitened(const Eigen::MatrixXd& columns) const {
  return lower_.triangularView<Eigen::Lower>().solve(columns);
}

DriveFit DriveRegression::fit(const Share& share) const {
  const Eigen::VectorXd y = errors_ - Eigen::VectorXd(whitened(share.known));
  const Eigen::Index windows = y.size() - drives_;
  if (share.columns.cols() == 0)
    return {.drives = all_left(y.head(drives_)), .windows = all_left(y.tail(windows))};
  const Eigen::MatrixXd x = whitened(share.columns);
  const Information information{.drives = squares_of(x.topRows(drives_)),
                                .windows = squares_of(x.bottomRows(windows))};
  const Eigen::VectorXd by_drives = x.topRows(drives_).transpose() * y.head(drives_);
  const Eigen::VectorXd by_windows = x.bottomRows(windows).transpose() * y.tail(windows);
  DriveFit fit;
  double of_drives = 1.0;
  double of_windows = 1.0;
  constexpr int kSettled = 20;  // steps after which the factors change no more
  const int steps = windows > 0 ? kSettled : 1;
  for (int step = 0; step < steps; ++step) {
    fit.coefficients = information.inverse(of_drives, of_windows) *
                       (of_drives * by_drives + of_windows * by_windows);
    const Eigen::VectorXd left = y - x * fit.coefficients;
    fit.drives = residuals_of(left.head(drives_));
    fit.windows = residuals_of(left.tail(windows));
    of_drives = weight_of(fit.drives);
    of_windows = weight_of(fit.windows);
  }
  fit.share_of_drives =
      of_drives * (information.inverse(of_drives, of_windows) * information.drives).diagonal();
  fit.drives.freedom = fit.drives.size - fit.share_of_drives.sum();
  fit.windows.freedom =
      fit.windows.size - (static_cast<double>(x.cols()) - fit.share_of_drives.sum());
  fit.covariance = information.inverse(1.0 / fit.drives.inflation(),
                                       windows > 0 ? 1.0 / fit.windows.inflation() : 0.0);
  return fit;
}

double DriveRegression::gain(const DriveFit& without, const DriveFit& with) {
  return log_likelihood(with.drives) - log_likelihood(without.drives) +
         log_likelihood(with.windows) - log_likelihood(without.windows);
}

double DriveRegression::share_of_drives(const Eigen::VectorXd& known, const DriveFit& fit) const {
  const Eigen::VectorXd x = whitened(known);
  const double of_drives = weight_of(fit.drives) * x.head(drives_).squaredNorm();
  const double of_windows = weight_of(fit.windows) * x.tail(x.size() - drives_).squaredNorm();
  return of_drives > 0.0 ? of_drives / (of_drives + of_windows) : 1.0;
}

double surprisal_of_drives(double gain_nats, std::size_t parameters, double freedom, double size) {
  if (!(gain_nats > 0.0) || !(freedom > 0.0)) return 0.0;
  // The share of the residual that is left has the law of beta(freedom / 2, parameters / 2).
  const double left = std::exp(-2.0 * gain_nats / size);
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
