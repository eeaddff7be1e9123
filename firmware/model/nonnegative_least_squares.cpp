#include "firmware/model/nonnegative_least_squares.hpp"

#include <Eigen/QR>
#include <limits>

namespace zerorate::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// The unconstrained solution in the free variables; zero in the others.
/// `free` holds 1 for a free variable and 0 for one that is held at zero.
VectorXd solve_free(const MatrixXd& A, const VectorXd& b, const VectorXd& free) {
  const MatrixXd free_columns = A * free.asDiagonal();
  return free.cwiseProduct(free_columns.completeOrthogonalDecomposition().solve(b));
}

bool is_feasible(const VectorXd& z, const VectorXd& free) {
  return (free.array() == 0.0 || z.array() > 0.0).all();
}

/// Goes from x towards z until a free variable becomes zero, and holds that one from then on.
void step_to_boundary(VectorXd& x, const VectorXd& z, VectorXd& free) {
  double share = 1.0;
  Index blocking = 0;
  for (Index i = 0; i < x.size(); ++i) {
    if (free(i) != 0.0 && z(i) <= 0.0 && x(i) / (x(i) - z(i)) <= share) {
      share = x(i) / (x(i) - z(i));
      blocking = i;
    }
  }
  x += share * (z - x);
  free(blocking) = 0.0;
  x = x.cwiseProduct(free);
}

}  // namespace

VectorXd nonnegative_least_squares(const MatrixXd& A, const VectorXd& b) {
  const double tolerance = 100.0 * kEpsilon * A.norm() * b.norm();
  VectorXd x = VectorXd::Zero(A.cols());
  VectorXd free = VectorXd::Zero(A.cols());
  // Each round frees the variable that helps most. In exact arithmetic the sum of squares falls in
  // every round and no set of free variables comes back; the bound is for rounding errors.
  for (Index round = 0; round < 3 * A.cols(); ++round) {
    const VectorXd descent =
        (A.transpose() * (b - A * x)).cwiseProduct(VectorXd::Ones(free.size()) - free);
    Index entering = 0;
    if (descent.maxCoeff(&entering) <= tolerance) {
      break;
    }
    free(entering) = 1.0;
    VectorXd z = solve_free(A, b, free);
    while (!is_feasible(z, free)) {
      step_to_boundary(x, z, free);
      z = solve_free(A, b, free);
    }
    x = z;
  }
  return x;
}

}  // namespace zerorate::model
