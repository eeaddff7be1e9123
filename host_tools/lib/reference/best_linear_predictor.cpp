#include "host_tools/lib/reference/best_linear_predictor.hpp"

#include <Eigen/LU>

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

}  // namespace zerorate::reference
