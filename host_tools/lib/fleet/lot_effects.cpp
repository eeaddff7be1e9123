// Differences of lots from those that agree, with intervals.

#include <Eigen/LU>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "host_tools/lib/fleet/lots.hpp"

namespace zerorate::fleet {
namespace {

/// Score and information of the axes of one sensor about a common mean.
struct SensorScore {
  Point score = Point::Zero();
  Matrix information = Matrix::Zero();
};

/// Likeliest mean of sensors less that of the population, with its error.
struct GroupMean {
  Point shift = Point::Zero();
  Matrix covariance = Matrix::Zero();
  double freedom = 0.0;  ///< sensors less one
};

/// One step of Newton from the mean that the scores are about. The errors are a sandwich over
/// sensors, whose axes depend on each other.
GroupMean mean_of(const std::vector<SensorScore>& sensors) {
  Point score = Point::Zero();
  Matrix information = Matrix::Zero();
  for (const SensorScore& one : sensors) {
    score += one.score;
    information += one.information;
  }
  information.diagonal() *= 1.0 + 1e-9;
  const Matrix inverse = information.inverse();
  const auto count = static_cast<double>(sensors.size());
  GroupMean mean{.shift = inverse * score, .freedom = count - 1.0};
  Matrix squares = Matrix::Zero();
  for (const SensorScore& one : sensors) {
    const Point left = one.score - one.information * mean.shift;
    squares += left * left.transpose();
  }
  mean.covariance = inverse * squares * inverse * (count / (count - 1.0));
  return mean;
}

class Effects {
 public:
  Effects(Population& population, const KeptLikelihood& likelihood)
      : population_(population),
        likelihood_(likelihood),
        precision_(population.distribution.covariance.inverse()) {}

  void measure() {
    std::map<std::size_t, GroupMean> lots;
    std::map<std::size_t, GroupMean> references;
    for (LotFigure& figure : population_.lot_figures) {
      const auto* const name = std::ranges::find(kCoordinateNames, figure.what);
      if (name == kCoordinateNames.end()) continue;
      if (!lots.contains(figure.lot)) {
        lots[figure.lot] = mean_of_lot(figure.lot);
        references[figure.lot] = mean_of_reference(figure.lot);
      }
      set_effect(figure, static_cast<int>(name - kCoordinateNames.begin()), lots[figure.lot],
                 references[figure.lot]);
    }
  }

 private:
  /// Scores by sensor of the members that are asked for, about a mean of the population's shape.
  template <class Wanted>
  std::vector<SensorScore> scores(const Point& shift, const Wanted& is_wanted) const {
    std::map<std::size_t, SensorScore> sensors;
    const Normal about{.mean = population_.distribution.mean + shift,
                       .covariance = population_.distribution.covariance};
    for (std::size_t i = 0; i < population_.members.size(); ++i) {
      const Member& member = population_.members[i];
      if (!is_wanted(member)) continue;
      const AxisLikelihood* const kept = shift.isZero() ? nullptr : likelihood_(i);
      const Normal posterior =
          kept != nullptr ? evidence_of(*kept, about).posterior : member.evidence.posterior;
      // A posterior about another mean, where the likelihood is gone, is moved as if it were
      // normal.
      const Point& mean = kept != nullptr ? about.mean : population_.distribution.mean;
      SensorScore& sensor = sensors[member.sensor];
      sensor.score += precision_ * (posterior.mean - mean);
      sensor.information += precision_ - precision_ * posterior.covariance * precision_;
      if (kept == nullptr) {
        sensor.score -= (precision_ - precision_ * posterior.covariance * precision_) * shift;
      }
    }
    std::vector<SensorScore> list;
    list.reserve(sensors.size());
    for (const auto& [sensor, score] : sensors) list.push_back(score);
    return list;
  }

  /// Clean members where there are enough sensors of them, else all.
  template <class Wanted>
  GroupMean mean_about(const Point& shift, const Wanted& is_wanted) const {
    std::vector<SensorScore> clean =
        scores(shift, [&](const Member& member) { return member.is_clean && is_wanted(member); });
    if (clean.size() < kFewestSensorsOfLot) clean = scores(shift, is_wanted);
    GroupMean mean = mean_of(clean);
    mean.shift += shift;
    return mean;
  }

  /// Likelihoods are no normals: the mean of a lot far away is found about itself.
  [[nodiscard]] GroupMean mean_of_lot(std::size_t lot) const {
    const auto is_wanted = [&](const Member& member) { return member.lot == lot; };
    GroupMean mean = mean_about(Point::Zero(), is_wanted);
    if (population_.lots[lot].is_reference) return mean;
    constexpr int kSteps = 3;
    for (int step = 0; step < kSteps && mean.shift.allFinite(); ++step) {
      mean = mean_about(mean.shift, is_wanted);
    }
    return mean;
  }
  [[nodiscard]] GroupMean mean_of_reference(std::size_t lot) const {
    return mean_about(Point::Zero(), [&](const Member& member) {
      return member.lot != lot && population_.lots[member.lot].is_reference;
    });
  }

  void set_effect(LotFigure& figure, int coordinate, const GroupMean& lot,
                  const GroupMean& reference) const {
    const double of_lot = lot.covariance(coordinate, coordinate);
    const double of_reference = reference.covariance(coordinate, coordinate);
    const double variance = of_lot + of_reference;
    const double value = lot.shift[coordinate] - reference.shift[coordinate];
    constexpr double kUnknown = 5.0;  // spreads of the population
    if (!std::isfinite(value) ||
        !(std::sqrt(variance) < kUnknown * population_.spread(coordinate))) {
      return;
    }
    // Degrees of freedom of a difference of two means (Welch 1947).
    const double freedom =
        variance * variance /
        (of_lot * of_lot / lot.freedom + of_reference * of_reference / reference.freedom);
    const double quantile =
        boost::math::quantile(boost::math::students_t{std::max(freedom, 1.0)}, 0.975);
    const double half = quantile * std::sqrt(variance);
    figure.effect = LotEffect{value, value - half, value + half};
    const auto in_place = [&](const GroupMean& mean) {
      const double x = population_.distribution.mean[coordinate] + mean.shift[coordinate];
      return coordinate == 2 ? x : std::exp(x);
    };
    figure.lot_value = in_place(lot);
    figure.other_value = in_place(reference);
  }

  Population& population_;
  const KeptLikelihood& likelihood_;
  Matrix precision_;
};

}  // namespace

void measure_lot_effects(Population& population, const KeptLikelihood& likelihood) {
  Effects{population, likelihood}.measure();
}

}  // namespace zerorate::fleet
