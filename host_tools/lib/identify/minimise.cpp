#include "host_tools/lib/identify/minimise.hpp"

#include <nlopt.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <exception>
#include <functional>
#include <memory>
#include <numbers>

#include "host_tools/lib/parallel/parallel.hpp"

namespace zerorate::identify {
namespace {

/// Function that the C library calls: an exception must not cross it.
struct Call {
  const Objective& function;
  nlopt_opt optimiser;
  std::exception_ptr failure;
};

double evaluate(unsigned size, const double* x, double* /*gradient*/, void* data) {
  Call& call = *static_cast<Call*>(data);
  try {
    return call.function(Eigen::Map<const Eigen::VectorXd>(x, static_cast<Eigen::Index>(size)));
  } catch (...) {
    call.failure = std::current_exception();
    nlopt_force_stop(call.optimiser);
    return HUGE_VAL;
  }
}

/// Calls work(0) .. work(count - 1), at the same time.
void for_each(Eigen::Index count, const std::function<void(Eigen::Index)>& work) {
  parallel::for_each(static_cast<std::size_t>(count), parallel::kAllThreads,
                     [&](std::size_t i) { work(static_cast<Eigen::Index>(i)); }, {});
}

}  // namespace

Minimum minimise(const Objective& function, const Eigen::VectorXd& start,
                 const Eigen::MatrixXd& steps, const Eigen::VectorXd& lowest,
                 const Eigen::VectorXd& highest) {
  constexpr int kMostEvaluations = 400;
  constexpr double kTolerance = 0.03;
  const auto place = [&](const Eigen::VectorXd& walked) -> Eigen::VectorXd {
    return start + steps * walked;
  };
  const Objective along_steps = [&](const Eigen::VectorXd& walked) {
    return function(place(walked));
  };
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> optimiser{
      nlopt_create(NLOPT_LN_BOBYQA, static_cast<unsigned>(start.size())), &nlopt_destroy};
  Call call{along_steps, optimiser.get(), nullptr};
  nlopt_set_min_objective(optimiser.get(), &evaluate, &call);
  const Eigen::VectorXd fewest_steps = (lowest - start).cwiseQuotient(steps.diagonal());
  const Eigen::VectorXd most_steps = (highest - start).cwiseQuotient(steps.diagonal());
  nlopt_set_lower_bounds(optimiser.get(), fewest_steps.data());
  nlopt_set_upper_bounds(optimiser.get(), most_steps.data());
  nlopt_set_initial_step1(optimiser.get(), 1.0);
  nlopt_set_xtol_abs1(optimiser.get(), kTolerance);
  nlopt_set_maxeval(optimiser.get(), kMostEvaluations);
  Eigen::VectorXd walked = Eigen::VectorXd::Zero(start.size());
  double value = HUGE_VAL;
  nlopt_optimize(optimiser.get(), walked.data(), &value);
  if (call.failure) std::rethrow_exception(call.failure);
  return {place(walked), value};
}

Eigen::MatrixXd covariance(const Objective& function, const Minimum& minimum,
                           Eigen::MatrixXd steps) {
  constexpr double kWanted = 0.5;  // second difference, at half a standard error
  constexpr double kNear = 1.5;    // a ratio of distances that makes no difference
  const auto second_difference = [&](const Eigen::VectorXd& d) {
    return function(minimum.at + d) + function(minimum.at - d) - 2.0 * minimum.value;
  };
  const Eigen::Index size = minimum.at.size();
  Eigen::MatrixXd second(size, size);
  steps *= 0.5;
  for_each(size, [&](Eigen::Index i) {
    auto step = steps.col(i);
    second(i, i) = second_difference(step);
    // A flat function is not followed for ever.
    const double ratio =
        second(i, i) > 0.0 ? std::clamp(std::sqrt(kWanted / second(i, i)), 0.05, 5.0) : 1.0;
    if (ratio <= kNear && ratio * kNear >= 1.0) return;
    step *= ratio;
    second(i, i) = second_difference(step);
  });
  for_each(size * size, [&](Eigen::Index place) {
    const Eigen::Index i = place / size;
    const Eigen::Index j = place % size;
    if (i <= j) return;
    second(i, j) = second(j, i) =
        0.5 * (second_difference(steps.col(i) + steps.col(j)) - second(i, i) - second(j, j));
  });
  // In units of these steps a well determined direction has the eigenvalue 1/2.
  constexpr double kFlat = 1e-4;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(second);
  const Eigen::VectorXd variances = 2.0 * axes.eigenvalues().cwiseMax(kFlat).cwiseInverse();
  const Eigen::MatrixXd directions = steps * axes.eigenvectors();
  return directions * variances.asDiagonal() * directions.transpose();
}

Eigen::MatrixXd independent_steps(
    const std::function<Eigen::VectorXd(double angular_frequency)>& slopes,
    const Sampling& sampling, const Eigen::VectorXd& longest) {
  constexpr double kPerOctave = 8.0;
  Eigen::MatrixXd information = longest.cwiseAbs2().cwiseInverse().asDiagonal();
  const double slowest = 2.0 * std::numbers::pi / (sampling.period_s * sampling.values);
  for (double cycles = 1.0; cycles < 0.5 * sampling.values; cycles *= std::exp2(1.0 / kPerOctave)) {
    const Eigen::VectorXd slope = slopes(cycles * slowest);
    information += cycles * std::numbers::ln2 / kPerOctave * slope * slope.transpose();
  }
  const Eigen::Index size = longest.size();
  return information.llt().matrixU().solve(Eigen::MatrixXd::Identity(size, size));
}

}  // namespace zerorate::identify
