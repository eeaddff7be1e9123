#include "host_tools/lib/diagnose/node_scores.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "core/estimator/kalman_predictor.hpp"
#include "core/estimator/temperature_track.hpp"
#include "firmware/model/node_model.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::size_t kDecaying = model::kMostDecaying;
constexpr std::size_t kRotating = model::kMostRotating;
constexpr std::size_t kTemperature = model::kMostTemperature;
using Filter = core::KalmanPredictor<kDecaying, kRotating, kTemperature>;
using Noise = core::Transition<kDecaying, kRotating>;
using NodeModel = model::NodeModel<kDecaying, kRotating>;

/// The filter at a tick; what is between the ticks that it measures is a gap.
class Node {
 public:
  Node(const NodeModel& node, core::Duration tick)
      : node_(node),
        tick_(tick),
        one_tick_(node.modes.one_tick()),
        coefficients_(node.modes, node.gate, node.temperature),
        temperature_(node.temperature) {}

  /// Time goes on to the end of this tick.
  void enter(const identify::TickMean& mean, float temperature_degc) {
    temperature_.take(core::Instant{} + tick_ * std::int64_t{mean.tick}, true, temperature_degc);
    const std::uint32_t ticks = mean.tick + 1 - measured_ticks_;
    static_cast<Noise&>(lead_) = ticks == 1 ? one_tick_ : node_.modes.over(ticks);
    temperature_.lead_over(ticks, lead_);
  }
  /// The tick that was entered last.
  core::Innovation measure(const identify::TickMean& mean) {
    Filter::Span since_last = lead_;
    temperature_.measure(temperature_.tick(), since_last);
    measured_ticks_ = mean.tick + 1;
    return filter_.step(since_last, mean.rate_rad_s[0],
                        node_.measurement_variance(static_cast<float>(mean.samples)));
  }
  [[nodiscard]] double bias_rad_s() const { return double{filter_.bias_rad_s(lead_)}; }
  /// Of the drive that began after the newest measurement and ends now.
  [[nodiscard]] double heading_sigma_rad() const {
    Filter::Span drive{node_.modes.over(lead_.ticks)};
    temperature_.over_drive(lead_, lead_.ticks, drive);
    const Filter::Span none{node_.modes.over(0)};
    return double{filter_.predict_heading(none, drive).sigma_rad()};
  }

 private:
  const NodeModel& node_;
  core::Duration tick_;
  Noise one_tick_;  ///< the span of nearly all steps
  Filter::Coefficients coefficients_;
  Filter filter_{coefficients_};
  core::TemperatureTrack<kTemperature> temperature_;
  Filter::Span lead_{};               ///< from the newest measurement to the tick entered last
  std::uint32_t measured_ticks_ = 0;  ///< up to and with the newest measurement
};

/// Calls visit(mean, temperature) for all ticks in order.
template <class Visit>
void for_each_tick(const ScoredTicks& scored, Visit visit) {
  for (std::size_t k = 0; k < scored.ticks.size(); ++k) {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    visit(scored.ticks[k], scored.temperature_degc.empty() ? kNone : scored.temperature_degc[k]);
  }
}

double log_density(const core::Innovation& innovation) {
  if (innovation.rejected) return std::numeric_limits<double>::quiet_NaN();
  const double variance = double{innovation.variance_rad2_s2};
  const double residual = double{innovation.residual_rad_s};
  return -0.5 * (std::log(2.0 * std::numbers::pi * variance) + residual * residual / variance);
}

std::vector<double> log_scores(const NodeModel& model, const ScoredTicks& scored) {
  Node node(model, scored.tick);
  std::vector<double> scores;
  scores.reserve(scored.ticks.size());
  for_each_tick(scored, [&](const identify::TickMean& mean, float temperature_degc) {
    node.enter(mean, temperature_degc);
    const core::Innovation innovation = node.measure(mean);
    if (mean.tick >= scored.judged_from && !innovation.first) {
      scores.push_back(log_density(innovation));
    }
  });
  return scores;
}

std::vector<ScoredDrive> drives(const NodeModel& model, const ScoredTicks& scored) {
  Node node(model, scored.tick);
  std::vector<ScoredDrive> all;
  const double tick_s = static_cast<double>(scored.tick.ns()) * 1e-9;
  const std::uint32_t cycle = scored.stop_ticks + scored.drive_ticks;
  std::uint32_t drive_number = 0;
  double white_rad2 = 0.0;
  for_each_tick(scored, [&](const identify::TickMean& mean, float temperature_degc) {
    node.enter(mean, temperature_degc);
    const std::uint32_t judged =
        mean.tick < scored.judged_from ? 0 : mean.tick - scored.judged_from;
    if (mean.tick < scored.judged_from || judged % cycle < scored.stop_ticks) {
      node.measure(mean);
      return;
    }
    if (all.empty() || drive_number != judged / cycle) {
      drive_number = judged / cycle;
      all.emplace_back();
      white_rad2 = 0.0;
    }
    ScoredDrive& drive = all.back();
    const double error = double{mean.rate_rad_s[0]} - node.bias_rad_s();
    drive.integrated_rad += error * tick_s;
    drive.squares_rad2_s2 += error * error;
    white_rad2 +=
        double{model.measurement_variance(static_cast<float>(mean.samples))} * tick_s * tick_s;
    if (++drive.ticks == scored.drive_ticks) {
      drive.sigma_rad = std::hypot(node.heading_sigma_rad(), std::sqrt(white_rad2));
    }
  });
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
