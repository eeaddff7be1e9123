#include "host_tools/lib/reference/best_linear_predictor.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <boost/math/quadrature/tanh_sinh.hpp>
#include <cmath>
#include <numbers>

namespace zerorate::reference {

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
