#include "host_tools/lib/experiments/paper/expectation.hpp"

#include <cmath>
#include <numbers>

#include "host_tools/lib/reference/best_linear_predictor.hpp"

namespace zerorate::experiments {

using Eigen::Index;
using Eigen::MatrixXd;

Expectation expect(const Predictor& predictor, const reference::FractionalNoise& noise,
                   const Lengths& lengths) {
  // The answers of a linear predictor to each sample alone are its weights.
  const auto n = static_cast<Index>(lengths.calibration);
  const Forecasts answers = predictor.predict(MatrixXd::Identity(n, n));
  const MatrixXd covariance = reference::error_covariance(noise, answers.bias);
  const reference::NormMoments rsse = reference::gaussian_norm(covariance);
  const Eigen::ArrayXd stated_over_true =
      answers.sigma.col(0).array() / covariance.diagonal().array().sqrt();
  const auto within_two = [](double ratio) { return std::erf(std::numbers::sqrt2 * ratio); };
  return {.std_ie = std::sqrt(covariance.sum()),
          .mean_rsse = rsse.mean,
          .std_rsse = rsse.standard_deviation,
          .coverage = stated_over_true.unaryExpr(within_two).mean()};
}

}  // namespace zerorate::experiments
