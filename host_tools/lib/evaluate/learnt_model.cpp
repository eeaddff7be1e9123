#include "host_tools/lib/evaluate/learnt_model.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "firmware/model/hypotheses.hpp"
#include "host_tools/lib/recording/json.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::evaluate {
namespace {

/// Standard deviation of an even distribution over a step of the mesh.
double deviation_of_step(double step) {
  return step / std::sqrt(12.0);
}

LearntInterval normal(const app::LearntFigure& figure, double step) {
  const double value{figure.value};
  const double half_width =
      statistics::kHalfWidth95 * std::hypot(double{figure.sigma}, deviation_of_step(step));
  return {.value = value, .lo = value - half_width, .hi = value + half_width};
}

LearntInterval log_normal(const app::LearntFigure& figure, double unit, double log_step) {
  const double value = double{figure.value} * unit;
  const double relative = double{figure.sigma} / double{figure.value};
  const double log_variance = std::log1p(relative * relative);
  const double median = value * std::exp(-0.5 * log_variance);
  const double factor = std::exp(statistics::kHalfWidth95 *
                                 std::hypot(std::sqrt(log_variance), deviation_of_step(log_step)));
  return {.value = value, .lo = median / factor, .hi = median * factor};
}

}  // namespace

std::string in_words(const LearntInterval& figure) {
  return fmt::format("{:.3g} ({:.3g} to {:.3g})", figure.value, figure.lo, figure.hi);
}

LearntMesh mesh_of(const model::SensorModel& model) {
  constexpr double kWalk = 0.95;  // a higher order is that of a random walk
  std::vector<double> orders;
  std::vector<double> log_ratios;
  LearntMesh mesh;
  for (const model::FlickerHypothesis& one : model::hypotheses_of(model)) {
    if (one.flicker.order >= kWalk) continue;
    const double log_ratio =
        std::log(one.flicker.bias_instability_rad_s / model.white.angle_random_walk_rad_per_sqrt_s);
    if (orders.empty() || one.flicker.order != orders.back()) {
      orders.push_back(one.flicker.order);
    } else {
      mesh.log_amplitude_step = log_ratio - log_ratios.back();
    }
    log_ratios.push_back(log_ratio);
  }
  if (orders.empty()) return mesh;
  mesh.lowest_order = std::ranges::min(orders);
  mesh.highest_order = std::ranges::max(orders);
  mesh.order_step = orders.size() > 1
                        ? mesh.highest_order - mesh.lowest_order
                        : std::sqrt(12.0) * model.prior.value_or(model::Prior{}).order_sigma;
  mesh.lowest_ratio = std::exp(std::ranges::min(log_ratios));
  mesh.highest_ratio = std::exp(std::ranges::max(log_ratios));
  return mesh;
}

LearntModel learnt_model(const app::LearntNoise& noise, const LearntMesh& mesh) {
  LearntModel learnt{.order = normal(noise.order, mesh.order_step),
                     .bias_instability_dph = log_normal(
                         noise.bias_instability_rad_s, units::kDphPerRadS, mesh.log_amplitude_step),
                     .angle_random_walk_dps_per_sqrt_hz =
                         log_normal(noise.angle_random_walk_rad_per_sqrt_s, units::kDegPerRad, 0.0),
                     .stops = double{noise.stops}};
  constexpr double kNear = 0.1;  // share of a step
  const auto is_at_edge = [](double x, double lowest, double highest, double step) {
    return x < lowest + kNear * step || x > highest - kNear * step;
  };
  if (mesh.highest_order > mesh.lowest_order && mesh.order_step > 0.0) {
    learnt.is_order_at_edge =
        is_at_edge(learnt.order.value, mesh.lowest_order, mesh.highest_order, mesh.order_step);
  }
  if (mesh.highest_ratio > 0.0) {
    const double ratio = double{noise.bias_instability_rad_s.value} /
                         double{noise.angle_random_walk_rad_per_sqrt_s.value};
    learnt.is_bias_instability_at_edge =
        is_at_edge(std::log(ratio), std::log(mesh.lowest_ratio), std::log(mesh.highest_ratio),
                   mesh.log_amplitude_step);
  }
  return learnt;
}

std::string edge_in_words(const LearntModel& learnt, const LearntMesh& mesh) {
  std::string text;
  if (learnt.is_order_at_edge && learnt.order.value > 0.5 * (mesh.highest_order + 1.0)) {
    text = fmt::format(
        "the bias drifts like a random walk, beyond the flicker noises that the node tries, of the "
        "orders {:.3g} to {:.3g}; temperature or warm-up may be why",
        mesh.lowest_order, mesh.highest_order);
  } else if (learnt.is_order_at_edge) {
    text = fmt::format("d is at the edge of the orders that the node tries, {:.3g} to {:.3g}",
                       mesh.lowest_order, mesh.highest_order);
  }
  if (learnt.is_bias_instability_at_edge) {
    text += fmt::format("{}B is at the edge of the strengths that the node tries",
                        text.empty() ? "" : "; ");
  }
  if (!text.empty()) text += ": the sensor may lie beyond";
  return text;
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
  json["order_at_edge"] = learnt.is_order_at_edge;
  json["bias_instability_at_edge"] = learnt.is_bias_instability_at_edge;
  return json;
}

}  // namespace zerorate::evaluate
