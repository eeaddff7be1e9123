#include "host_tools/lib/evaluate/learnt_model.hpp"

#include <fmt/format.h>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "host_tools/lib/recording/json.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::evaluate {
namespace {

LearntInterval normal(const app::LearntFigure& figure) {
  const double value{figure.value};
  const double half_width = statistics::kHalfWidth95 * double{figure.sigma};
  return {.value = value, .lo = value - half_width, .hi = value + half_width};
}

LearntInterval log_normal(const app::LearntFigure& figure, double unit) {
  const double value = double{figure.value} * unit;
  const double relative = double{figure.sigma} / double{figure.value};
  const double log_variance = std::log1p(relative * relative);
  const double median = value * std::exp(-0.5 * log_variance);
  const double factor = std::exp(statistics::kHalfWidth95 * std::sqrt(log_variance));
  return {.value = value, .lo = median / factor, .hi = median * factor};
}

}  // namespace

std::string in_words(const LearntInterval& figure) {
  return fmt::format("{:.3g} ({:.3g} to {:.3g})", figure.value, figure.lo, figure.hi);
}

LearntModel learnt_model(const app::LearntNoise& noise) {
  return {.order = normal(noise.order),
          .bias_instability_dph = log_normal(noise.bias_instability_rad_s, units::kDphPerRadS),
          .angle_random_walk_dps_per_sqrt_hz =
              log_normal(noise.angle_random_walk_rad_per_sqrt_s, units::kDegPerRad),
          .stops = double{noise.stops}};
}

nlohmann::ordered_json learnt_json(const LearntModel& learnt) {
  using recording::number;
  nlohmann::ordered_json json{{"stops", number(learnt.stops)}};
  const auto add = [&](const std::string& key, const LearntInterval& figure) {
    json[key] = number(figure.value);
    json[key + "_ci95"] = {number(figure.lo), number(figure.hi)};
  };
  add("order", learnt.order);
  add("bias_instability_dph", learnt.bias_instability_dph);
  add("angle_random_walk_dps_per_sqrt_hz", learnt.angle_random_walk_dps_per_sqrt_hz);
  return json;
}

}  // namespace zerorate::evaluate
