#include "host_tools/lab/reference/fractional_noise.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <boost/math/quadrature/tanh_sinh.hpp>
#include <cmath>
#include <numbers>

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

using Eigen::Index;
using Eigen::MatrixXd;

LinearPredictor make_best_linear_predictor(const FractionalNoise& noise, Bias bias,
                                           std::size_t samples, std::size_t leads) {
  const auto n = static_cast<Index>(samples);
  const auto m = static_cast<Index>(leads);
  const Index unknowns = bias == Bias::diffuse ? n + 1 : n;
  const MatrixXd c = covariance(noise, samples + leads);

  MatrixXd kriging = MatrixXd::Ones(unknowns, unknowns);
  kriging.topLeftCorner(n, n) = c.topLeftCorner(n, n);
  kriging.diagonal().head(n).array() += noise.white_variance;
  MatrixXd right = MatrixXd::Ones(unknowns, m);
  right.topRows(n) = c.topRightCorner(n, m);
  if (bias == Bias::diffuse) kriging(n, n) = 0.0;

  const MatrixXd solution = kriging.partialPivLu().solve(right);
  return {
      .weights = solution.topRows(n).transpose(),
      .variance = c.diagonal().tail(m) - solution.cwiseProduct(right).colwise().sum().transpose()};
}

NormMoments gaussian_norm(const Eigen::MatrixXd& covariance) {
  const double trace = covariance.trace();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance, Eigen::EigenvaluesOnly);
  const Eigen::ArrayXd lambda = solver.eigenvalues().array().max(0.0) / trace;
  // With s = e^t the integrand falls like e^(-|t| / 2) on both sides: less than 1e-10 lies beyond.
  constexpr double kFar = 50.0;
  const auto integrand = [&lambda](double t) {
    const double log_transform = -0.5 * (2.0 * std::exp(t) * lambda).log1p().sum();
    return -std::expm1(log_transform) * std::exp(-0.5 * t);
  };
  boost::math::quadrature::tanh_sinh<double> quadrature;
  const double integral = quadrature.integrate(integrand, -kFar, kFar, 1e-9);
  const double mean = integral / (2.0 * std::sqrt(std::numbers::pi));  // in units of sqrt(trace)
  return {mean * std::sqrt(trace), std::sqrt((1.0 - mean * mean) * trace)};
}

}  // namespace zerorate::reference
