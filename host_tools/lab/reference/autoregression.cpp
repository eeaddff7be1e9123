#include "host_tools/lab/reference/autoregression.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <stdexcept>

namespace zerorate::reference {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

VectorXd as_vector(std::span<const double> values) {
  return Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()));
}

/// One iterated step: what the newest values, newest last, make of the next one.
double next(const VectorXd& coefficients, const VectorXd& values, Index known) {
  return coefficients.dot(
      values.segment(known - coefficients.size(), coefficients.size()).reverse());
}

}  // namespace

Autoregression fit_least_squares(std::span<const double> values, std::size_t order) {
  if (values.size() <= 2 * order) {
    throw std::invalid_argument("fit_least_squares: too few values for the order");
  }
  const auto p = static_cast<Index>(order);
  VectorXd deviation = as_vector(values);
  const double mean = deviation.mean();
  deviation.array() -= mean;
  const Index equations = deviation.size() - p;
  MatrixXd lagged(equations, p);
  for (Index i = 0; i < p; ++i) lagged.col(i) = deviation.segment(p - 1 - i, equations);
  const VectorXd coefficients = lagged.householderQr().solve(deviation.tail(equations));
  const double residual = (deviation.tail(equations) - lagged * coefficients).squaredNorm();
  return {mean, coefficients, residual / static_cast<double>(equations - p)};
}

Autoregression fit_burg(std::span<const double> values, std::size_t order) {
  if (values.size() <= order) throw std::invalid_argument("fit_burg: too few values for the order");
  VectorXd forward = as_vector(values);
  const double mean = forward.mean();
  forward.array() -= mean;
  VectorXd backward = forward;
  VectorXd coefficients(0);
  double variance = forward.squaredNorm() / static_cast<double>(forward.size());
  for (Index i = 0; i < static_cast<Index>(order); ++i) {
    const Index left = forward.size() - 1;
    const VectorXd f = forward.tail(left);
    const VectorXd b = backward.head(left);
    const double reflection = 2.0 * f.dot(b) / (f.squaredNorm() + b.squaredNorm());
    VectorXd longer(i + 1);
    longer << coefficients - reflection * coefficients.reverse(), reflection;
    coefficients = longer;
    forward = f - reflection * b;
    backward = b - reflection * f;
    variance *= 1.0 - reflection * reflection;
  }
  return {mean, coefficients, variance};
}

Forecast forecast(const Autoregression& model, std::span<const double> values, std::size_t leads) {
  const Index p = model.coefficients.size();
  const auto m = static_cast<Index>(leads);
  VectorXd deviation(p + m);
  deviation.head(p) = as_vector(values.last(static_cast<std::size_t>(p))).array() - model.mean;
  VectorXd impulse = VectorXd::Zero(p + m);
  Forecast result{VectorXd(m), VectorXd(m)};
  double gain = 0.0;
  for (Index j = 0; j < m; ++j) {
    impulse(p + j) = j == 0 ? 1.0 : next(model.coefficients, impulse, p + j);
    deviation(p + j) = next(model.coefficients, deviation, p + j);
    gain += impulse(p + j) * impulse(p + j);
    result.variance(j) = gain * model.innovation_variance;
  }
  result.values = deviation.tail(m).array() + model.mean;
  return result;
}

MatrixXd forecast_weights(const Autoregression& model, std::size_t leads) {
  const Index p = model.coefficients.size();
  const auto m = static_cast<Index>(leads);
  const VectorXd oldest_first = model.coefficients.reverse();
  MatrixXd columns(p, p + m);  // column of each value, known or forecast; contiguous in time
  columns.leftCols(p).setIdentity();
  for (Index j = 0; j < m; ++j) {
    columns.col(p + j).noalias() = columns.middleCols(j, p) * oldest_first;
  }
  return columns.rightCols(m).transpose();
}

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Rows x columns of the lower triangular Toeplitz matrix of psi, from row `first` on.
MatrixXd integration_rows(const VectorXd& psi, Index first, Index rows, Index columns) {
  MatrixXd integration = MatrixXd::Zero(rows, columns);
  for (Index j = 0; j < columns; ++j) {
    for (Index i = std::max(Index{0}, j - first); i < rows; ++i) {
      integration(i, j) = psi(first + i - j);
    }
  }
  return integration;
}

}  // namespace

LinearPredictor make_plug_in_predictor(const FractionalNoise& noise, std::size_t samples,
                                       std::size_t leads) {
  const auto n = static_cast<Index>(samples);
  const auto m = static_cast<Index>(leads);
  const VectorXd psi = impulse_response(noise.order, samples + leads);
  const MatrixXd calibration = integration_rows(psi, 0, n, n);
  const MatrixXd later = integration_rows(psi, n, m, n);

  MatrixXd measured = MatrixXd::Identity(n, n) * noise.white_variance;
  measured.selfadjointView<Eigen::Lower>().rankUpdate(calibration, noise.innovation_variance);
  const MatrixXd cross = noise.innovation_variance * later * calibration.transpose();
  const MatrixXd gain =
      measured.selfadjointView<Eigen::Lower>().llt().solve(cross.transpose()).transpose();

  LinearPredictor predictor;
  predictor.variance.resize(m);
  double prior = noise.innovation_variance * psi.head(n).squaredNorm();
  for (Index j = 0; j < m; ++j) {
    prior += noise.innovation_variance * psi(n + j) * psi(n + j);
    predictor.variance(j) = prior - gain.row(j).dot(cross.row(j));
  }
  const VectorXd share_of_mean = (1.0 - gain.rowwise().sum().array()) / static_cast<double>(n);
  predictor.weights = gain.colwise() + share_of_mean;
  return predictor;
}

}  // namespace zerorate::reference
