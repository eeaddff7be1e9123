#include "host_tools/lib/reference/plug_in_predictor.hpp"

#include <Eigen/Cholesky>

namespace zerorate::reference {

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
