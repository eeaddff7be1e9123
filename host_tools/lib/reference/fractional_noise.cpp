#include "host_tools/lib/reference/fractional_noise.hpp"

#include "host_tools/lib/spectrum/fractional_filter.hpp"

namespace zerorate::reference {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd impulse_response(double order, std::size_t n) {
  VectorXd psi(static_cast<Index>(n));
  spectrum::FractionalWeights weights{order};
  for (double& value : psi) value = weights.next();
  return psi;
}

MatrixXd covariance(const FractionalNoise& noise, std::size_t n) {
  const VectorXd psi = impulse_response(noise.order, n);
  const auto size = static_cast<Index>(n);
  MatrixXd c = noise.innovation_variance * psi * psi.transpose();
  for (Index j = 1; j < size; ++j) {
    for (Index i = 1; i < size; ++i) c(i, j) += c(i - 1, j - 1);
  }
  return c;
}

VectorXd error_variance(const FractionalNoise& noise, const MatrixXd& weights) {
  const Index leads = weights.rows();
  const Index samples = weights.cols();
  const MatrixXd c = covariance(noise, static_cast<std::size_t>(leads + samples));
  MatrixXd measured = c.topLeftCorner(samples, samples);
  measured.diagonal().array() += noise.white_variance;
  const MatrixXd half = weights * measured - 2.0 * c.bottomLeftCorner(leads, samples);
  return half.cwiseProduct(weights).rowwise().sum() + c.diagonal().tail(leads);
}

MatrixXd error_covariance(const FractionalNoise& noise, const MatrixXd& weights) {
  const Index leads = weights.rows();
  const Index samples = weights.cols();
  MatrixXd c = covariance(noise, static_cast<std::size_t>(leads + samples));
  c.diagonal().array() += noise.white_variance;
  // A c A' by the blocks of A = (-weights, 1).
  const MatrixXd predicted = weights * c.topRightCorner(samples, leads);
  return weights * c.topLeftCorner(samples, samples) * weights.transpose() - predicted -
         predicted.transpose() + c.bottomRightCorner(leads, leads);
}

}  // namespace zerorate::reference
