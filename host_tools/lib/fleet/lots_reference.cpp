// Lots that agree with each other: the robust centre with which all lots are compared.

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "host_tools/lib/fleet/lots.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::fleet {
namespace {

/// Squared distance beyond which a lot does not belong to a centre: chi squared of three degrees of
/// freedom, p = 1e-4.
constexpr double kFarthest = 21.1;

struct LotCentre {
  std::size_t lot = 0;
  double sensors = 0.0;
  Point centre = Point::Zero();
};

/// Positions of the sensors of each lot, in which single sensors have no more than a limited pull.
class Centres {
 public:
  explicit Centres(const Population& population) {
    std::vector<std::vector<Point>> of_lots(population.lots.size());
    const std::vector<Point> means = means_of(population);
    for (std::size_t i = 0; i < means.size(); ++i) {
      of_lots[population.sensors[i].lot].push_back(means[i]);
    }
    for (std::size_t lot = 0; lot < of_lots.size(); ++lot) {
      if (of_lots[lot].size() < kFewestSensorsOfLot) continue;
      centres_.push_back({.lot = lot,
                          .sensors = static_cast<double>(of_lots[lot].size()),
                          .centre = median_of(of_lots[lot])});
      for (const Point& one : of_lots[lot]) residuals_.emplace_back(one - centres_.back().centre);
      owners_.resize(residuals_.size(), centres_.size() - 1);
    }
    limit_pulls();
  }

  [[nodiscard]] const std::vector<LotCentre>& centres() const { return centres_; }
  /// Squared distance in units of the variance of a sensor's position.
  [[nodiscard]] double squared(const Point& difference) const {
    return difference.dot(precision_ * difference);
  }

 private:
  /// Mean over the axes and recordings of each sensor.
  static std::vector<Point> means_of(const Population& population) {
    std::vector<Point> sums(population.sensors.size(), Point::Zero());
    std::vector<double> counts(population.sensors.size());
    for (const Member& member : population.members) {
      sums[member.sensor] += member.evidence.posterior.mean;
      counts[member.sensor] += 1.0;
    }
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] /= std::max(counts[i], 1.0);
    return sums;
  }
  static Point median_of(const std::vector<Point>& points) {
    Point median;
    for (int k = 0; k < kCoordinates; ++k) {
      std::vector<double> values;
      values.reserve(points.size());
      for (const Point& one : points) values.push_back(one[k]);
      median[k] = statistics::median_of(std::move(values));
    }
    return median;
  }

  /// Moves each centre by the mean of its residuals, none larger than three deviations, and takes
  /// the covariance of the sensors from the same.
  void limit_pulls() {
    constexpr double kMadOfSigma = 0.6745;
    constexpr double kMostSigmas = 3.0;
    Point limit;
    for (int k = 0; k < kCoordinates; ++k) {
      std::vector<double> sizes;
      sizes.reserve(residuals_.size());
      for (const Point& one : residuals_) sizes.push_back(std::abs(one[k]));
      const double mad = sizes.empty() ? 0.0 : statistics::median_of(std::move(sizes));
      limit[k] = std::max(kMostSigmas * mad / kMadOfSigma, 1e-9);
    }
    std::vector<Point> shifts(centres_.size(), Point::Zero());
    for (std::size_t i = 0; i < residuals_.size(); ++i) {
      residuals_[i] = residuals_[i].cwiseMax(-limit).cwiseMin(limit);
      shifts[owners_[i]] += residuals_[i] / centres_[owners_[i]].sensors;
    }
    Matrix squares = Matrix::Zero();
    for (std::size_t i = 0; i < residuals_.size(); ++i) {
      const Point left = residuals_[i] - shifts[owners_[i]];
      squares += left * left.transpose();
    }
    for (std::size_t i = 0; i < centres_.size(); ++i) centres_[i].centre += shifts[i];
    const double freedom =
        static_cast<double>(residuals_.size()) - static_cast<double>(centres_.size());
    squares /= std::max(freedom, 1.0);
    squares.diagonal().array() += 1e-12;
    precision_ = squares.inverse();
  }

  std::vector<LotCentre> centres_;
  std::vector<Point> residuals_;
  std::vector<std::size_t> owners_;  ///< centre of each residual
  Matrix precision_ = Matrix::Identity();
};

/// Indices of centres.
using Group = std::vector<std::size_t>;

Point mean_of(const Centres& all, const Group& group) {
  Point sum = Point::Zero();
  double sensors = 0.0;
  for (const std::size_t i : group) {
    sum += all.centres()[i].sensors * all.centres()[i].centre;
    sensors += all.centres()[i].sensors;
  }
  return sum / sensors;
}

/// Lots that agree within chance, found from one of them: those near their own mean.
Group grow(const Centres& all, std::size_t first) {
  constexpr int kMostSteps = 20;
  Group group{first};
  for (int step = 0; step < kMostSteps; ++step) {
    const Point mean = mean_of(all, group);
    double sensors = 0.0;
    for (const std::size_t i : group) sensors += all.centres()[i].sensors;
    Group next;
    for (std::size_t i = 0; i < all.centres().size(); ++i) {
      const LotCentre& one = all.centres()[i];
      const double error = 1.0 / one.sensors + 1.0 / sensors;
      if (all.squared(one.centre - mean) <= kFarthest * error) next.push_back(i);
    }
    if (next.empty() || next == group) break;
    group = std::move(next);
  }
  return group;
}

/// The half of the lots that lies closest about one of them.
Group closest_half(const Centres& all) {
  const std::size_t half = (all.centres().size() + 1) / 2;
  Group closest;
  double least = 0.0;
  for (const LotCentre& middle : all.centres()) {
    std::vector<std::pair<double, std::size_t>> distances;
    for (std::size_t i = 0; i < all.centres().size(); ++i) {
      distances.emplace_back(all.squared(all.centres()[i].centre - middle.centre), i);
    }
    std::ranges::sort(distances);
    if (!closest.empty() && distances[half - 1].first >= least) continue;
    least = distances[half - 1].first;
    closest.clear();
    for (std::size_t i = 0; i < half; ++i) closest.push_back(distances[i].second);
  }
  return closest;
}

/// Sum of ln N and ln B.
double log_noise(const Point& mean) {
  return mean[0] + mean[1];
}

}  // namespace

void choose_reference_lots(Population& population) {
  for (Lot& lot : population.lots) lot.is_reference = false;
  const Centres all{population};
  if (all.centres().empty()) return;
  std::optional<Group> quietest;
  for (std::size_t i = 0; i < all.centres().size(); ++i) {
    Group group = grow(all, i);
    if (2 * group.size() < all.centres().size()) continue;
    if (quietest && log_noise(mean_of(all, group)) >= log_noise(mean_of(all, *quietest))) continue;
    quietest = std::move(group);
  }
  if (!quietest) {
    population.warnings.emplace_back(
        "no half of the lots agrees within chance; they are compared with the half that differs "
        "least");
    quietest = closest_half(all);
  }
  for (const std::size_t i : *quietest) population.lots[all.centres()[i].lot].is_reference = true;
}

}  // namespace zerorate::fleet
