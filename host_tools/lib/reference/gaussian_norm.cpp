#include "host_tools/lib/reference/gaussian_norm.hpp"

#include <Eigen/Eigenvalues>
#include <boost/math/quadrature/tanh_sinh.hpp>
#include <cmath>
#include <numbers>

namespace zerorate::reference {

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
