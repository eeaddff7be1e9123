// Likelihood of an axis over the coordinates of the population, and the population of many axes.

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "host_tools/lib/fleet/analysis.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::fleet {
namespace {

/// The widened population that brings every likelihood to moments has so many times its spread.
constexpr double kWidening = 4.0;
/// Information, in units of the widened population's, below which a direction counts as unknown.
constexpr double kLeastInformation = 0.05;
/// Points less likely than the best one by more nats add nothing.
constexpr float kLeastLikely = -14.0F;
/// Points between two neighbours of the grid.
constexpr std::size_t kFinerOrders = 2;
constexpr std::size_t kFinerAmplitudes = 4;

/// Cubic through four neighbours of which the middle two enclose the place (Catmull and Rom 1974).
double cubic(const std::array<double, 4>& p, double t) {
  return p[1] + 0.5 * t *
                    (p[2] - p[0] +
                     t * (2.0 * p[0] - 5.0 * p[1] + 4.0 * p[2] - p[3] +
                          t * (3.0 * (p[1] - p[2]) + p[3] - p[0])));
}

/// Values of cells at a place of the grid, in cells.
double interpolate(const std::vector<double>& cells, double order, double amplitude) {
  const auto neighbours = [](double place, std::size_t count) {
    const auto below =
        std::min(static_cast<std::ptrdiff_t>(place), static_cast<std::ptrdiff_t>(count) - 2);
    std::array<std::size_t, 4> indices{};
    for (std::ptrdiff_t k = 0; k < 4; ++k) {
      indices[static_cast<std::size_t>(k)] = static_cast<std::size_t>(
          std::clamp<std::ptrdiff_t>(below + k - 1, 0, static_cast<std::ptrdiff_t>(count) - 1));
    }
    return std::pair{indices, place - static_cast<double>(below)};
  };
  const auto rows = neighbours(order, Grid::kOrders);
  const auto columns = neighbours(amplitude, Grid::kAmplitudes);
  std::array<double, 4> of_rows{};
  for (std::size_t i = 0; i < 4; ++i) {
    std::array<double, 4> of_row{};
    for (std::size_t j = 0; j < 4; ++j) {
      of_row[j] = cells[rows.first[i] * Grid::kAmplitudes + columns.first[j]];
    }
    of_rows[i] = cubic(of_row, columns.second);
  }
  return cubic(of_rows, rows.second);
}

/// Moments of likelihood times normal. The error of ln N at a point is integrated in closed form.
Normal moments_under(const AxisLikelihood& axis, const Normal& prior, std::vector<double>& work) {
  const Matrix precision = prior.covariance.inverse();
  const Point along{1.0, 1.0, 0.0};  // an error of ln N is one of ln B
  const Point pull = precision * along;
  const double variance = 1.0 / (along.dot(pull) + 1.0 / axis.log_white_variance);
  const std::vector<GridPoint>& points = axis.points;
  work.resize(points.size());
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Point x = points[k].position.cast<double>() - prior.mean;
    const double pulled = pull.dot(x);
    work[k] = double{points[k].log_likelihood} -
              0.5 * (x.dot(precision * x) - variance * pulled * pulled);
    best = std::max(best, work[k]);
  }
  double sum = 0.0;
  Normal moments{.mean = Point::Zero(), .covariance = Matrix::Zero()};
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double weight = std::exp(work[k] - best);
    if (weight < 1e-12) continue;
    Point x = points[k].position.cast<double>() - prior.mean;
    x -= variance * pull.dot(x) * along;
    sum += weight;
    moments.mean += weight * x;
    moments.covariance += weight * x * x.transpose();
  }
  moments.mean /= sum;
  moments.covariance = moments.covariance / sum - moments.mean * moments.mean.transpose() +
                       variance * along * along.transpose();
  moments.mean += prior.mean;
  return moments;
}

/// One step of expectation and maximisation: sums over the axes only.
Normal next(const std::vector<AxisLikelihood>& axes, const std::vector<bool>& is_in,
            const Normal& now) {
  std::vector<double> work;
  Point sum = Point::Zero();
  Matrix squares = Matrix::Zero();
  double count = 0.0;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (!is_in[i]) continue;
    const Normal one = moments_under(axes[i], now, work);
    const Point x = one.mean - now.mean;
    sum += x;
    squares += one.covariance + x * x.transpose();
    count += 1.0;
  }
  sum /= count;
  Normal then{.mean = now.mean + sum, .covariance = squares / count - sum * sum.transpose()};
  // No direction narrower than the grid resolves.
  then.covariance.diagonal() += Point{1e-6, 1e-4, 1e-5};
  return then;
}

}  // namespace

Normal fit_normal(const std::vector<AxisLikelihood>& axes, const std::vector<bool>& is_in,
                  Normal now) {
  constexpr int kMostSteps = 300;
  constexpr double kSmall = 2e-4;  // share of a spread
  for (int step = 0; step < kMostSteps; ++step) {
    const Normal then = next(axes, is_in, now);
    const Point spread = then.covariance.diagonal().cwiseSqrt();
    const Point moved = (then.mean - now.mean).cwiseAbs().cwiseQuotient(spread);
    const Point widened =
        (spread - now.covariance.diagonal().cwiseSqrt()).cwiseAbs().cwiseQuotient(spread);
    now = then;
    if (moved.maxCoeff() < kSmall && widened.maxCoeff() < kSmall) break;
  }
  return now;
}

SensorEvidence evidence_of(const AxisLikelihood& axis, const Normal& population) {
  SensorEvidence evidence;
  std::vector<double> work;
  evidence.posterior = moments_under(axis, population, work);
  const Normal wide{.mean = population.mean,
                    .covariance = kWidening * kWidening * population.covariance};
  const Normal moments = moments_under(axis, wide, work);
  const Matrix root = wide.covariance.llt().matrixL();
  const Matrix whitener = root.inverse();
  Matrix covariance = whitener * moments.covariance * whitener.transpose();
  covariance.diagonal().array() += 1e-9;
  const Matrix precision = covariance.inverse();
  const Point shift = precision * (whitener * (moments.mean - wide.mean));
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen{precision - Matrix::Identity()};
  double squared = 0.0;
  int freedom = 0;
  for (int k = 0; k < kCoordinates; ++k) {
    const double information = eigen.eigenvalues()[k];
    if (information < kLeastInformation) continue;
    const Point direction = eigen.eigenvectors().col(k);
    const double along = direction.dot(shift);
    evidence.information += information * direction * direction.transpose();
    evidence.shift += along * direction;
    squared += along * along / (information * information / (kWidening * kWidening) + information);
    ++freedom;
  }
  if (freedom > 0) evidence.log_p = statistics::log_chi_squared_tail(squared, freedom);
  return evidence;
}

std::pair<double, int> squared_norm(const Matrix& information, const Point& shift) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen{information};
  double squared = 0.0;
  int rank = 0;
  for (int k = 0; k < kCoordinates; ++k) {
    if (eigen.eigenvalues()[k] < kLeastInformation) continue;
    const double along = eigen.eigenvectors().col(k).dot(shift);
    squared += along * along / eigen.eigenvalues()[k];
    ++rank;
  }
  return {squared, rank};
}

AxisLikelihood likelihood_of(const AxisResult& axis) {
  const std::vector<double> log_likelihood(axis.log_likelihood.begin(), axis.log_likelihood.end());
  std::vector<double> log_white;
  for (const float white : axis.white) log_white.push_back(std::log(double{white}));
  AxisLikelihood fine{.points = {},
                      .log_white_variance = 0.5 / static_cast<double>(axis.innovations)};
  const double pivot = std::log(Grid::kPivot_rad_s);
  for (std::size_t i = 0; i <= (Grid::kOrders - 1) * kFinerOrders; ++i) {
    for (std::size_t j = 0; j <= (Grid::kAmplitudes - 1) * kFinerAmplitudes; ++j) {
      const double row = static_cast<double>(i) / kFinerOrders;
      const double column = static_cast<double>(j) / kFinerAmplitudes;
      const auto likelihood = static_cast<float>(interpolate(log_likelihood, row, column));
      if (likelihood < kLeastLikely) continue;
      const double order = std::lerp(Grid::order(0), Grid::order(1), row);
      const double amplitude = std::lerp(Grid::log_amplitude(0), Grid::log_amplitude(1), column);
      const double white = interpolate(log_white, row, column);
      const double flicker = white + amplitude + order * pivot;
      fine.points.push_back(
          {.position = Point{white, flicker, order}.cast<float>(), .log_likelihood = likelihood});
    }
  }
  return fine;
}

Profile profile_of(const AxisLikelihood& axis, int coordinate) {
  Profile profile{.lo = std::numeric_limits<double>::infinity(),
                  .hi = -std::numeric_limits<double>::infinity()};
  float best = -std::numeric_limits<float>::infinity();
  for (const GridPoint& point : axis.points) {
    const double x = double{point.position[coordinate]};
    if (point.log_likelihood > best) {
      best = point.log_likelihood;
      profile.best = x;
    }
    const double left_nats = double{point.log_likelihood} + statistics::kHalfChiSquared95;
    if (left_nats < 0.0) continue;
    // The error of ln N takes the nats that the point leaves of the interval's.
    const double error =
        coordinate < 2 ? std::sqrt(2.0 * left_nats * axis.log_white_variance) : 0.0;
    profile.lo = std::min(profile.lo, x - error);
    profile.hi = std::max(profile.hi, x + error);
  }
  return profile;
}

std::vector<double> weights_of_cells(const std::vector<std::vector<float>>& log_likelihoods) {
  constexpr int kSteps = 300;
  std::vector<std::vector<float>> likelihoods = log_likelihoods;
  for (auto& axis : likelihoods) {
    for (float& one : axis) one = std::exp(one);
  }
  std::vector<double> weights(Grid::kCells, 1.0 / Grid::kCells);
  std::vector<double> sums(Grid::kCells);
  for (int step = 0; step < kSteps && !likelihoods.empty(); ++step) {
    std::ranges::fill(sums, 0.0);
    for (const auto& axis : likelihoods) {
      double all = 0.0;
      for (std::size_t k = 0; k < Grid::kCells; ++k) all += weights[k] * double{axis[k]};
      for (std::size_t k = 0; k < Grid::kCells; ++k) sums[k] += weights[k] * double{axis[k]} / all;
    }
    for (std::size_t k = 0; k < Grid::kCells; ++k) {
      weights[k] = sums[k] / static_cast<double>(likelihoods.size());
    }
  }
  return weights;
}

}  // namespace zerorate::fleet
