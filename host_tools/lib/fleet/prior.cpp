// Model of the next sensor of a population.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "host_tools/lib/fleet/population.hpp"

namespace zerorate::fleet {
namespace {

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
