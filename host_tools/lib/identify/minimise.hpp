/// @file
/// Minima of smooth functions of a few parameters whose values are a little rough, and how sharp
/// they are.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace zerorate::identify {

using Objective = std::function<double(const Eigen::VectorXd&)>;

struct Minimum {
  Eigen::VectorXd at;
  double value;
};

/// BOBYQA (Powell 2009) by NLopt, to a hundredth of a step. An exception of the function ends it
/// and is passed on.
/// @param step positive; how far each of the two or more parameters should move at first: about
///        the distance over which the function changes by a few units
/// @param room how far each may move from its start at most
[[nodiscard]] Minimum minimise(const Objective& function, const Eigen::VectorXd& start,
                               const Eigen::VectorXd& step, const Eigen::VectorXd& room);

/// The covariance of parameters of which the function is -2 log likelihood: twice the inverse of
/// its second derivatives at the minimum, by central differences over the distance at which it has
/// risen by about one. A direction in which it does not rise gets an enormous variance.
/// @param step a first idea of these distances
[[nodiscard]] Eigen::MatrixXd covariance(const Objective& function, const Minimum& minimum,
                                         const Eigen::VectorXd& step);

}  // namespace zerorate::identify
