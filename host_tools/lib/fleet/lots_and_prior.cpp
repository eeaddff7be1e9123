// Lots of a population, and the model of the next sensor.

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/hypergeometric.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "host_tools/lib/fleet/population.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::fleet {
namespace {

constexpr std::size_t kFewestSensorsOfLot = 4;

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

/// Two-sided p-values of a lot's ranks among all, exact for small lots: the normal p-value of four
/// sensors among eighty is never below 8e-4, too much to name one of twenty lots.
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
    std::vector<double>& tail = tails_[own];
    if (tail.empty()) tail = statistics::rank_sum_tail(own, others);
    return std::min(1.0, 2.0 * tail[static_cast<std::size_t>(middle - off)]);
  }

 private:
  static constexpr std::size_t kMostExact = 50;       ///< sensors of a lot
  std::map<std::size_t, std::vector<double>> tails_;  ///< key: size of the lot
};

LotFigure compare_noise(const Population& population, std::size_t lot, int coordinate,
                        const std::vector<double>& values, const std::vector<double>& ranks,
                        RankSums& rank_sums) {
  std::vector<double> own;
  std::vector<double> others;
  std::vector<bool> is_of_lot;
  for (std::size_t i = 0; i < values.size(); ++i) {
    is_of_lot.push_back(population.sensors[i].lot == lot);
    const double value = coordinate == 2 ? values[i] : std::exp(values[i]);
    (is_of_lot.back() ? own : others).push_back(value);
  }
  return {.lot = lot,
          .what = kCoordinateNames[static_cast<std::size_t>(coordinate)],
          .lot_value = statistics::median_of(std::move(own)),
          .other_value = statistics::median_of(std::move(others)),
          .p_value = rank_sums.p_value(ranks, is_of_lot)};
}

/// Probability of at least so many outliers in the lot, were they spread by chance.
LotFigure compare_outliers(const Population& population, std::size_t lot) {
  unsigned own = 0;
  unsigned all = 0;
  for (const Sensor& sensor : population.sensors) {
    if (!sensor.is_outlier) continue;
    ++all;
    if (sensor.lot == lot) ++own;
  }
  const auto sensors = static_cast<unsigned>(population.sensors.size());
  const auto of_lot = static_cast<unsigned>(population.lots[lot].sensors);
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
  for (LotFigure& figure : population.lot_figures) {
    figure.differs = population.lots[figure.lot].differs && log_p_of(figure) <= largest_named;
  }
}

/// Mean and variance over the cells.
struct Spread {
  double mean = 0.0;
  double variance = 0.0;
};
Spread spread_over_cells(const std::vector<double>& weights, double (*value)(std::size_t cell)) {
  Spread spread;
  for (std::size_t k = 0; k < weights.size(); ++k) spread.mean += weights[k] * value(k);
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const double deviation = value(k) - spread.mean;
    spread.variance += weights[k] * deviation * deviation;
  }
  return spread;
}

/// Standard deviation that the next sensor is expected to have: few sensors leave most of what is
/// thought of sensors in general, and the mean itself is uncertain.
double expected_sigma(double variance, double general_sigma, double sensors) {
  constexpr double kSensorsOfGeneral = 4.0;
  const double pooled = (kSensorsOfGeneral * general_sigma * general_sigma + sensors * variance) /
                        (kSensorsOfGeneral + sensors);
  return std::sqrt(pooled + variance / sensors);
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
  std::vector<std::size_t> compared;
  for (std::size_t i = 0; i < population.lots.size(); ++i) {
    Lot& lot = population.lots[i];
    lot.q_value = 1.0;
    lot.differs = false;
    if (!lot.name.empty() && lot.sensors >= kFewestSensorsOfLot &&
        population.sensors.size() >= lot.sensors + kFewestSensorsOfLot) {
      compared.push_back(i);
    }
  }
  RankSums rank_sums;
  for (int coordinate = 0; coordinate < kCoordinates; ++coordinate) {
    const std::vector<double> values = means_of_sensors(population, coordinate);
    const std::vector<double> ranks = ranks_of(values);
    for (const std::size_t lot : compared) {
      population.lot_figures.push_back(
          compare_noise(population, lot, coordinate, values, ranks, rank_sums));
    }
  }
  for (const std::size_t lot : compared) {
    population.lot_figures.push_back(compare_outliers(population, lot));
  }
  name_lots(population, compared);
  std::ranges::stable_sort(population.lot_figures, {}, &LotFigure::p_value);
}

model::SensorModel type_model(const Population& population, const std::string& name) {
  std::set<std::size_t> sensors;
  for (const Member& member : population.members) {
    if (member.is_in_core) sensors.insert(member.sensor);
  }
  const auto count = static_cast<double>(sensors.size());
  const Spread order = spread_over_cells(
      population.weights, [](std::size_t cell) { return Grid::order(cell / Grid::kAmplitudes); });
  const Spread amplitude = spread_over_cells(population.weights, [](std::size_t cell) {
    return Grid::log_amplitude(cell % Grid::kAmplitudes);
  });
  const model::Prior general;
  model::SensorModel model{.name = name};
  const std::string source = fmt::format("{} sensors, by zerorate fleet prior", sensors.size());
  model.white = {std::exp(population.distribution.mean[0]), "median of " + source};
  model.flicker = model::Flicker{
      .bias_instability_rad_s = model.white.angle_random_walk_rad_per_sqrt_s *
                                std::exp(amplitude.mean) * std::pow(Grid::kPivot_rad_s, order.mean),
      .order = order.mean,
      .source = "median of " + source};
  model.prior = model::Prior{
      .order = order.mean,
      .order_sigma = std::min({expected_sigma(order.variance, general.order_sigma, count),
                               0.9 * order.mean, 0.9 * (1.0 - order.mean)}),
      .amplitude_factor =
          std::exp(expected_sigma(amplitude.variance, std::log(general.amplitude_factor), count)),
      .source = source};
  return model;
}

}  // namespace zerorate::fleet
