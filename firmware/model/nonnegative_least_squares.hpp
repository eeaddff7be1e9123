/// @file
/// Least squares with weights that may not be negative.
#pragma once

#include <Eigen/Core>

namespace zerorate::model {

/// The x >= 0 that minimises |A x - b|, with columns of A of comparable length.
/// Active-set method (Lawson and Hanson 1974, chapter 23).
[[nodiscard]] Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& A,
                                                        const Eigen::VectorXd& b);

}  // namespace zerorate::model
