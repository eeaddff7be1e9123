// Lots beside those that agree: which of them differ.

#include <algorithm>
#include <boost/math/distributions/hypergeometric.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host_tools/lib/fleet/lots.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::fleet {
namespace {

/// Mean of a coordinate over the axes and recordings of each sensor.
std::vector<double> means_of_sensors(const Population& population, int coordinate) {
  std::vector<double> sums(population.sensors.size());
  std::vector<double> counts(population.sensors.size());
  for (const Member& member : population.members) {
    sums[member.sensor] += member.evidence.posterior.mean[coordinate];
    counts[member.sensor] += 1.0;
  }
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] /= std::max(counts[i], 1.0);
  return sums;
}

std::vector<double> ranks_of(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return values[i]; });
  std::vector<double> ranks(values.size());
  for (std::size_t place = 0; place < order.size(); ++place) {
    ranks[order[place]] = static_cast<double>(place + 1);
  }
  return ranks;
}

/// Two-sided p-values of a lot's ranks among the reference, exact for small lots: the normal
/// p-value of four sensors among eighty is never below 8e-4, too much to name one of twenty lots.
class RankSums {
 public:
  double p_value(const std::vector<double>& ranks, const std::vector<bool>& is_of_lot) {
    double sum = 0.0;
    std::size_t own = 0;
    for (std::size_t i = 0; i < ranks.size(); ++i) {
      if (!is_of_lot[i]) continue;
      sum += ranks[i];
      ++own;
    }
    const std::size_t others = ranks.size() - own;
    const double middle = 0.5 * static_cast<double>(own * others);
    const double off = std::abs(sum - 0.5 * static_cast<double>(own * (own + 1)) - middle);
    if (own > kMostExact) {
      const double variance = middle * static_cast<double>(ranks.size() + 1) / 6.0;
      return 2.0 * statistics::normal_tail(off / std::sqrt(variance));
    }
    std::vector<double>& tail = tails_[{own, others}];
    if (tail.empty()) tail = statistics::rank_sum_tail(own, others);
    return std::min(1.0, 2.0 * tail[static_cast<std::size_t>(middle - off)]);
  }

 private:
  static constexpr std::size_t kMostExact = 50;                               ///< sensors of a lot
  std::map<std::pair<std::size_t, std::size_t>, std::vector<double>> tails_;  ///< key: both sizes
};

/// Whether a sensor is of the lot, or of the reference beside it; nothing where it is of neither.
std::optional<bool> side_of(const Population& population, const Sensor& sensor, std::size_t lot) {
  if (sensor.lot == lot) return true;
  if (population.lots[sensor.lot].is_reference) return false;
  return std::nullopt;
}

LotFigure compare_noise(const Population& population, std::size_t lot, int coordinate,
                        const std::vector<double>& means, RankSums& rank_sums) {
  std::vector<double> values;
  std::vector<double> own;
  std::vector<double> others;
  std::vector<bool> is_of_lot;
  for (std::size_t i = 0; i < means.size(); ++i) {
    const auto is_own = side_of(population, population.sensors[i], lot);
    if (!is_own) continue;
    is_of_lot.push_back(*is_own);
    values.push_back(means[i]);
    (*is_own ? own : others).push_back(coordinate == 2 ? means[i] : std::exp(means[i]));
  }
  return {.lot = lot,
          .what = kCoordinateNames[static_cast<std::size_t>(coordinate)],
          .lot_value = statistics::median_of(std::move(own)),
          .other_value = statistics::median_of(std::move(others)),
          .p_value = rank_sums.p_value(ranks_of(values), is_of_lot)};
}

/// Probability of at least so many outliers in the lot, were they spread by chance.
LotFigure compare_outliers(const Population& population, std::size_t lot) {
  unsigned own = 0;
  unsigned all = 0;
  unsigned of_lot = 0;
  unsigned sensors = 0;
  for (const Sensor& sensor : population.sensors) {
    const auto is_own = side_of(population, sensor, lot);
    if (!is_own) continue;
    ++sensors;
    if (*is_own) ++of_lot;
    if (!sensor.is_outlier) continue;
    ++all;
    if (*is_own) ++own;
  }
  const unsigned least = all + of_lot > sensors ? all + of_lot - sensors : 0;
  double p_value = 1.0;
  if (own > least) {
    const boost::math::hypergeometric_distribution<double> chance{all, of_lot, sensors};
    p_value = boost::math::cdf(boost::math::complement(chance, own - 1));
  }
  return {.lot = lot,
          .what = "outliers",
          .lot_value = static_cast<double>(own) / of_lot,
          .other_value = static_cast<double>(all - own) / (sensors - of_lot),
          .p_value = p_value};
}

/// Names the lots that differ, and the figures in which they do.
void name_lots(Population& population, const std::vector<std::size_t>& compared) {
  constexpr double kFigures = kCoordinates + 1;
  const auto log_p_of = [](const LotFigure& figure) {
    return std::min(0.0, std::log(kFigures * std::max(figure.p_value, 1e-300)));
  };
  std::vector<double> of_lots(population.lots.size());
  for (const LotFigure& figure : population.lot_figures) {
    of_lots[figure.lot] = std::min(of_lots[figure.lot], log_p_of(figure));
  }
  std::vector<double> log_p;
  log_p.reserve(compared.size());
  for (const std::size_t lot : compared) log_p.push_back(of_lots[lot]);
  const std::vector<double> q = q_values(log_p);
  double largest_named = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < compared.size(); ++i) {
    Lot& lot = population.lots[compared[i]];
    lot.q_value = q[i];
    lot.differs = q[i] <= population.options.false_discovery_rate;
    if (lot.differs) largest_named = std::max(largest_named, log_p[i]);
  }
  // Figures that would name their lot alone are shown of each lot that is named.
  const double shown = std::max(largest_named, std::log(population.options.false_discovery_rate));
  for (LotFigure& figure : population.lot_figures) {
    figure.differs = population.lots[figure.lot].differs && log_p_of(figure) <= shown;
  }
}

}  // namespace

std::vector<double> q_values(const std::vector<double>& log_p_values) {
  std::vector<std::size_t> order(log_p_values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return log_p_values[i]; });
  const auto count = static_cast<double>(order.size());
  std::vector<double> q(order.size());
  double least = 1.0;
  for (std::size_t place = order.size(); place-- > 0;) {
    const std::size_t i = order[place];
    least = std::min(least, std::exp(log_p_values[i]) * count / static_cast<double>(place + 1));
    q[i] = least;
  }
  return q;
}

void compare_lots(Population& population) {
  population.lot_figures.clear();
  std::size_t of_reference = 0;
  for (const Lot& lot : population.lots) of_reference += lot.is_reference ? lot.sensors : 0;
  std::vector<std::size_t> compared;
  for (std::size_t i = 0; i < population.lots.size(); ++i) {
    Lot& lot = population.lots[i];
    lot.q_value = 1.0;
    lot.differs = false;
    const std::size_t others = of_reference - (lot.is_reference ? lot.sensors : 0);
    if (!lot.name.empty() && lot.sensors >= kFewestSensorsOfLot && others >= kFewestSensorsOfLot) {
      compared.push_back(i);
    }
  }
  RankSums rank_sums;
  for (int coordinate = 0; coordinate < kCoordinates; ++coordinate) {
    const std::vector<double> means = means_of_sensors(population, coordinate);
    for (const std::size_t lot : compared) {
      population.lot_figures.push_back(
          compare_noise(population, lot, coordinate, means, rank_sums));
    }
  }
  for (const std::size_t lot : compared) {
    population.lot_figures.push_back(compare_outliers(population, lot));
  }
  name_lots(population, compared);
  std::ranges::stable_sort(population.lot_figures, {}, &LotFigure::p_value);
}

}  // namespace zerorate::fleet
