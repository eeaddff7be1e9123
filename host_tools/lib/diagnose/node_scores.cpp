#include "host_tools/lib/diagnose/node_scores.hpp"

#include <cmath>
#include <numbers>

#include "core/estimator/kalman_predictor.hpp"
#include "firmware/model/node_model.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::size_t kDecaying = model::kMostDecaying;
constexpr std::size_t kRotating = model::kMostRotating;
using Filter = core::KalmanPredictor<kDecaying, kRotating>;
using NodeModel = model::NodeModel<kDecaying, kRotating>;

/// The filter at a tick; what is between the ticks that it is shown is a gap.
class Node {
 public:
  explicit Node(const NodeModel& node)
      : node_(node), one_tick_(node.modes.one_tick()), coefficients_(node.modes, node.gate) {}

  core::Innovation observe(const identify::TickMean& mean) {
    const std::uint32_t ticks = mean.tick + 1 - ticks_;
    ticks_ = mean.tick + 1;
    return filter_.step(ticks == 1 ? one_tick_ : node_.modes.over(ticks), mean.rate_rad_s[0],
                        node_.measurement_variance(static_cast<float>(mean.samples)));
  }
  [[nodiscard]] double bias_rad_s(const identify::TickMean& mean) const {
    return double{filter_.bias_rad_s(node_.modes.over(mean.tick + 1 - ticks_))};
  }
  [[nodiscard]] core::HeadingPrediction predict_drive(std::uint32_t drive_ticks) const {
    return filter_.predict_heading(node_.modes.over(0), node_.modes.over(drive_ticks));
  }

 private:
  const NodeModel& node_;
  Filter::Span one_tick_;
  Filter::Coefficients coefficients_;
  Filter filter_{coefficients_};
  std::uint32_t ticks_ = 0;  ///< that the filter has seen the end of
};

std::vector<double> log_scores(const NodeModel& model, const ScoredTicks& scored) {
  Node node(model);
  std::vector<double> scores;
  scores.reserve(scored.ticks.size());
  for (const identify::TickMean& mean : scored.ticks) {
    const core::Innovation innovation = node.observe(mean);
    if (mean.tick < scored.judged_from || innovation.first) continue;
    const double variance = double{innovation.variance_rad2_s2};
    const double residual = double{innovation.residual_rad_s};
    scores.push_back(
        -0.5 * (std::log(2.0 * std::numbers::pi * variance) + residual * residual / variance));
  }
  return scores;
}

std::vector<ScoredDrive> drives(const NodeModel& model, const ScoredTicks& scored) {
  Node node(model);
  std::vector<ScoredDrive> all;
  const double tick_s = static_cast<double>(scored.tick.ns()) * 1e-9;
  const std::uint32_t cycle = scored.stop_ticks + scored.drive_ticks;
  std::uint32_t drive_number = 0;
  double white_rad2 = 0.0;
  for (const identify::TickMean& mean : scored.ticks) {
    const std::uint32_t judged =
        mean.tick < scored.judged_from ? 0 : mean.tick - scored.judged_from;
    if (mean.tick < scored.judged_from || judged % cycle < scored.stop_ticks) {
      node.observe(mean);
      continue;
    }
    if (all.empty() || drive_number != judged / cycle) {
      drive_number = judged / cycle;
      all.emplace_back();
      const double sigma = double{node.predict_drive(scored.drive_ticks).sigma_rad()};
      white_rad2 = sigma * sigma;
    }
    ScoredDrive& drive = all.back();
    const double error = double{mean.rate_rad_s[0]} - node.bias_rad_s(mean);
    drive.integrated_rad += error * tick_s;
    drive.squares_rad2_s2 += error * error;
    white_rad2 +=
        double{model.white_variance_rad2_s2} / static_cast<double>(mean.samples) * tick_s * tick_s;
    drive.sigma_rad = std::sqrt(white_rad2);
    ++drive.ticks;
  }
  // A drive that lost ticks, or that the record ends in, says something else.
  std::erase_if(all, [&](const ScoredDrive& d) { return d.ticks != scored.drive_ticks; });
  return all;
}

}  // namespace

NodeScores score(const model::SensorModel& model, const ScoredTicks& ticks) {
  const NodeModel node = model::make_full_node_model(model, ticks.sample_period, ticks.tick);
  return {drives(node, ticks), log_scores(node, ticks)};
}

}  // namespace zerorate::diagnose
