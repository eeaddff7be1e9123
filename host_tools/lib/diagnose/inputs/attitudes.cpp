#include "host_tools/lib/diagnose/inputs/attitudes.hpp"

#include <Eigen/Dense>
#include <numeric>

namespace zerorate::diagnose {

InputColumn acceleration_along(const InputTicks& ticks, const Direction& direction) {
  InputColumn column;
  column.reserve(ticks.size());
  for (const auto& g : ticks.acceleration_g) {
    column.push_back(std::inner_product(g.begin(), g.end(), direction.begin(), 0.0));
  }
  return column;
}

Attitudes attitudes_of(const InputTicks& ticks) {
  constexpr std::size_t kFewest = 2;
  std::array<std::vector<double>, 3> means;
  for (std::size_t i = 0; i < 3; ++i) {
    Direction unit{};
    unit[i] = 1.0;
    means[i] = means_by_standstill(ticks, acceleration_along(ticks, unit));
  }
  Attitudes attitudes{.directions = {}, .standstills = means[0].size()};
  if (attitudes.standstills < kFewest) return attitudes;
  Eigen::MatrixXd g(static_cast<Eigen::Index>(attitudes.standstills), 3);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const auto& column = means[static_cast<std::size_t>(i)];
    g.col(i) = Eigen::Map<const Eigen::VectorXd>(column.data(), g.rows());
  }
  g.rowwise() -= g.colwise().mean().eval();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(g.transpose() * g /
                                                              static_cast<double>(g.rows()));
  for (Eigen::Index i = 3; i-- > 0;) {
    if (solver.eigenvalues()[i] < kLeastSpread_g * kLeastSpread_g) break;
    const Eigen::Vector3d v = solver.eigenvectors().col(i);
    attitudes.directions.push_back({v[0], v[1], v[2]});
  }
  return attitudes;
}

}  // namespace zerorate::diagnose
