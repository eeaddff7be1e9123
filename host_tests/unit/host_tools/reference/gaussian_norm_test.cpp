#include "host_tools/lib/reference/best_linear_predictor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace zerorate::reference {
namespace {

using Eigen::MatrixXd;

TEST(GaussianNorm, OfEqualVariancesIsThatOfTheChiDistribution) {
  for (const int n : {1, 2, 7, 300}) {
    const NormMoments norm = gaussian_norm(9.0 * MatrixXd::Identity(n, n));
    const double chi =
        std::numbers::sqrt2 * std::exp(std::lgamma(0.5 * (n + 1)) - std::lgamma(0.5 * n));
    EXPECT_NEAR(norm.mean / (3.0 * chi), 1.0, 1e-8) << n;
    EXPECT_NEAR(norm.standard_deviation, 3.0 * std::sqrt(n - chi * chi), 1e-5 * norm.mean) << n;
  }
}

// In two dimensions the mean is sqrt(2 a / pi) E(sqrt(1 - b / a)), a >= b, with the complete
// elliptic integral of the second kind; turning the axes changes nothing.
TEST(GaussianNorm, OfAnyEllipseIsAnEllipticIntegral) {
  const double a = 5.0;
  const double b = 0.02;
  MatrixXd turn(2, 2);
  turn << 0.6, -0.8, 0.8, 0.6;
  const MatrixXd covariance = turn * Eigen::Vector2d(a, b).asDiagonal() * turn.transpose();
  const double expected =
      std::sqrt(2.0 * a / std::numbers::pi) * std::comp_ellint_2(std::sqrt(1.0 - b / a));
  EXPECT_NEAR(gaussian_norm(covariance).mean, expected, 1e-8 * expected);
}

// Directions without any variance (and eigenvalues that rounding makes negative) do no harm.
TEST(GaussianNorm, OfADegenerateCovarianceIsThatOfItsRank) {
  const Eigen::VectorXd along = Eigen::VectorXd::LinSpaced(50, 1.0, 2.0);
  const NormMoments norm = gaussian_norm(along * along.transpose());
  EXPECT_NEAR(norm.mean, along.norm() * std::sqrt(2.0 / std::numbers::pi), 1e-8 * along.norm());
}

}  // namespace
}  // namespace zerorate::reference
