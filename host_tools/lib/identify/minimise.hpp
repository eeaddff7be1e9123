/// @file
/// Minima of smooth functions of a few parameters whose values are a little rough, and how sharp
/// they are.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <functional>
#include <limits>

namespace zerorate::identify {

using Objective = std::function<double(const Eigen::VectorXd&)>;

struct Minimum {
  Eigen::VectorXd at;
  double value;
};

/// BOBYQA (Powell 2009) by NLopt, to a thirtieth of a step. An exception of the function ends it
/// and is passed on.
/// @param steps  columns of an upper triangular matrix, along which the search goes: best a
///               standard error each, and independent of each other
/// @param lowest, highest  limits of the parameters, each along its own step
[[nodiscard]] Minimum minimise(const Objective& function, const Eigen::VectorXd& start,
                               const Eigen::MatrixXd& steps, const Eigen::VectorXd& lowest,
                               const Eigen::VectorXd& highest);

/// The covariance of parameters of which the function is -2 log likelihood: twice the inverse of
/// its second derivatives at the minimum, by central differences over about half a standard error.
/// A direction in which the function does not rise gets an enormous variance.
/// @param function  called by several threads at once
/// @param steps  as of minimise(), to be lengthened or shortened to that
[[nodiscard]] Eigen::MatrixXd covariance(const Objective& function, const Minimum& minimum,
                                         Eigen::MatrixXd steps);

/// Evenly spaced values of a record.
struct Sampling {
  double period_s;
  double values;  ///< their number
};

/// Steps of a standard error, along which the parameters of a spectrum are expected to be
/// independent: columns of the inverse root, which is upper triangular, of the information that the
/// Fourier frequencies of the record hold (Whittle 1953).
/// @param slopes  of log S at an angular frequency [rad/s] by the parameters
/// @param longest  steps, where the record has no information
[[nodiscard]] Eigen::MatrixXd independent_steps(
    const std::function<Eigen::VectorXd(double angular_frequency)>& slopes,
    const Sampling& sampling, const Eigen::VectorXd& longest);

struct ScalarMinimum {
  double at;
  double value;  ///< not finite if no value of the scan is
};

/// Lowest point of a function that is smooth between the points of a scan: the scan, then Brent's
/// method around its lowest point.
/// @param steps of the scan, from `low` to `high`
/// @param bits of precision that Brent's method stops at
template <class Function>
[[nodiscard]] ScalarMinimum minimise(const Function& function, double low, double high, int steps,
                                     int bits) {
  const double step = (high - low) / steps;
  ScalarMinimum best{low, std::numeric_limits<double>::infinity()};
  for (int i = 0; i <= steps; ++i) {
    const double at = low + step * i;
    const double value = function(at);
    if (value < best.value) best = {at, value};
  }
  const auto [at, value] = boost::math::tools::brent_find_minima(
      function, std::max(low, best.at - step), std::min(high, best.at + step), bits);
  return value < best.value ? ScalarMinimum{at, value} : best;
}

}  // namespace zerorate::identify
