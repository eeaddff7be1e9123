#include "host_tools/lib/diagnose/forecast_gain/scores.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/estimator/kalman_predictor.hpp"
#include "core/samples/noise_level_track.hpp"
#include "core/samples/sample_screen.hpp"
#include "core/temperature/temperature_track.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::diagnose {

namespace {

/// The filter at a tick; what is between the ticks that it measures is a gap.
template <core::ModelShape Shape>
class Node {
 public:
  using Filter = core::KalmanPredictor<Shape>;
  using Noise = core::TransitionOf<Shape>;

  Node(const model::NodeModel<Shape>& node, core::Duration tick)
      : node_(node),
        tick_(tick),
        one_tick_(node.modes.one_tick()),
        coefficients_(node.modes, node.gate, drift_of(node)),
        temperature_(drift_of(node)) {}

  /// Time goes on to the end of this tick.
  void enter(const identify::TickMean& mean, float temperature_degc) {
    temperature_.take(core::Instant{} + tick_ * std::int64_t{mean.tick}, true, temperature_degc);
    const std::uint32_t ticks = mean.tick + 1 - measured_ticks_;
    node_.modes.lead_over(ticks, one_tick_, lead_);
    temperature_.lead_over(ticks, lead_);
    level_.advance(mean.tick + 1 - level_ticks_);
    level_ticks_ = mean.tick + 1;
  }
  /// Learns from the tick that was entered last. Calls visit(forecast, rate) for every sample that
  /// there is a forecast of.
  template <class Visit>
  void learn(const identify::TickMean& mean, std::span<const double> samples, Visit visit) {
    const core::Prediction predicted = filter_.predict(lead_);
    if (!predicted.is_available()) {
      measure(mean.tick, mean.rate_rad_s[0], static_cast<float>(mean.samples));
      return;
    }
    screen_.begin_tick(predicted.bias_rad_s,
                       predicted.variance_rad2_s2 + node_.measurement_floor_variance_rad2_s2,
                       white_variance());
    double sum = 0.0;
    float learnt = 0.0F;
    for (const double rate : samples) {
      visit(screen_.forecast(), rate);
      if (!screen_.take(static_cast<float>(rate))) continue;
      sum += rate;
      learnt += 1.0F;
    }
    if (learnt == 0.0F) return;
    measure(mean.tick, static_cast<float>(sum / double{learnt}), learnt);
    level_.observe(screen_.squares_rad2_s2() / (learnt * node_.white_variance_rad2_s2), learnt);
  }
  /// Learns a tick from its mean alone.
  core::Innovation learn(const identify::TickMean& mean) {
    return measure(mean.tick, mean.rate_rad_s[0], static_cast<float>(mean.samples));
  }
  [[nodiscard]] double bias_rad_s() const { return double{filter_.bias_rad_s(lead_)}; }
  /// Variance of a mean of so many samples in the tick that was entered last, whatever they are.
  [[nodiscard]] double measurement_variance(std::uint32_t samples) const {
    const core::SampleModel& model = node_.samples;
    float of_sample = white_variance();
    if (model.outliers.is_on()) of_sample += model.outliers.variance_in_sums();
    if (model.motion.is_on()) of_sample += model.motion.variance_in_sums();
    return double{of_sample / static_cast<float>(samples) +
                  node_.measurement_floor_variance_rad2_s2};
  }
  /// Heading sigma of the drive that began after the newest measurement and ends now.
  [[nodiscard]] double heading_sigma_rad() const {
    typename Filter::Transition drive{static_cast<const Noise&>(lead_)};
    temperature_.over_drive(lead_, lead_.ticks, drive);
    const typename Filter::Transition none{node_.modes.over(0)};
    return double{filter_.predict_heading(none, drive).sigma_rad()};
  }

 private:
  [[nodiscard]] static core::TemperatureBlock<Shape.temperature_weights> drift_of(
      const model::NodeModel<Shape>& node) {
    if constexpr (Shape.temperature_weights > 0) return node.temperature;
    return {};
  }
  [[nodiscard]] float white_variance() const {
    return level_.level() * node_.white_variance_rad2_s2;
  }
  core::Innovation measure(std::uint32_t tick, float rate_rad_s, float samples) {
    typename Filter::Transition since_last = lead_;
    temperature_.measure(temperature_.tick(), since_last);
    measured_ticks_ = tick + 1;
    return filter_.step(since_last, rate_rad_s,
                        white_variance() / samples + node_.measurement_floor_variance_rad2_s2);
  }

  const model::NodeModel<Shape>& node_;
  core::Duration tick_;
  Noise one_tick_;  ///< the span of nearly all steps
  typename Filter::Coefficients coefficients_;
  Filter filter_{coefficients_};
  [[no_unique_address]] core::TemperatureTrack<Shape.temperature_weights> temperature_;
  core::SampleScreen screen_{node_.samples};
  core::NoiseLevelTrack level_{node_.samples.level};
  typename Filter::Transition lead_{};  ///< from the newest measurement to the tick entered last
  std::uint32_t measured_ticks_ = 0;    ///< up to and with the newest measurement
  std::uint32_t level_ticks_ = 0;       ///< up to and with the tick entered last
};

/// Calls visit(mean, temperature, samples) for all ticks in order.
template <class Visit>
void for_each_tick(const ScoredTicks& scored, Visit visit) {
  std::size_t first = 0;
  for (std::size_t k = 0; k < scored.ticks.size(); ++k) {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    const identify::TickMean& mean = scored.ticks[k];
    visit(mean, scored.temperature_degc.empty() ? kNone : scored.temperature_degc[k],
          scored.rate_rad_s.empty() ? scored.rate_rad_s
                                    : scored.rate_rad_s.subspan(first, mean.samples));
    first += mean.samples;
  }
}

/// Looks at every sample only where the model asks for it: the filter is the same otherwise.
template <core::ModelShape Shape>
void learn(Node<Shape>& node, const model::NodeModel<Shape>& model, const identify::TickMean& mean,
           std::span<const double> samples) {
  if (model.samples.needs_screen()) {
    node.learn(mean, samples, [](const auto& /*forecast*/, double /*rate*/) {});
  } else {
    node.learn(mean);
  }
}

double log_density(const core::Innovation& innovation) {
  const double variance = double{innovation.variance_rad2_s2};
  const double residual = double{innovation.residual_rad_s};
  return -0.5 * (std::log(2.0 * std::numbers::pi * variance) + residual * residual / variance);
}

/// At an end of the range a tenth of the noise: as a histogram tells it.
template <core::ModelShape Shape>
Scale scale_of(const model::NodeModel<Shape>& model, double level_step_rad_s) {
  const double step = double{model.quantization_step_rad_s};
  const double of_means = double{model.measurement_floor_variance_rad2_s2};
  return {.step_rad_s = step,
          .unknown_step_rad_s = level_step_rad_s,
          .rounding_variance = std::max(step * step / 12.0 - of_means, 0.0),
          .end_cell_rad_s = 0.1 * std::sqrt(double{model.white_variance_rad2_s2}),
          .range = model.samples.range};
}

template <core::ModelShape Shape>
std::vector<double> log_scores(const model::NodeModel<Shape>& model, const ScoredTicks& scored,
                               ScoreOf what) {
  Node<Shape> node(model, scored.tick);
  const Scale scale = scale_of(model, scored.level_step_rad_s);
  std::vector<double> scores;
  scores.reserve(scored.ticks.size());
  for_each_tick(scored, [&](const identify::TickMean& mean, float temperature_degc,
                            std::span<const double> samples) {
    node.enter(mean, temperature_degc);
    double sum = 0.0;
    if (what == ScoreOf::samples) {
      node.learn(mean, samples, [&](const auto& forecast, double rate) {
        sum += log_score(forecast, rate, scale);
      });
    } else {
      const core::Innovation innovation = node.learn(mean);
      if (!innovation.first) sum = log_density(innovation);
    }
    if (mean.tick >= scored.judged_from) scores.push_back(sum);
  });
  return scores;
}

template <core::ModelShape Shape>
std::vector<ScoredDrive> drives(const model::NodeModel<Shape>& model, const ScoredTicks& scored) {
  Node<Shape> node(model, scored.tick);
  std::vector<ScoredDrive> all;
  const double tick_s = static_cast<double>(scored.tick.ns()) * 1e-9;
  const std::uint32_t cycle = scored.stop_ticks + scored.drive_ticks;
  std::uint32_t drive_number = 0;
  double white_rad2 = 0.0;
  for_each_tick(scored, [&](const identify::TickMean& mean, float temperature_degc,
                            std::span<const double> samples) {
    node.enter(mean, temperature_degc);
    const std::uint32_t judged =
        mean.tick < scored.judged_from ? 0 : mean.tick - scored.judged_from;
    if (mean.tick < scored.judged_from || judged % cycle < scored.stop_ticks) {
      learn(node, model, mean, samples);
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
    white_rad2 += node.measurement_variance(mean.samples) * tick_s * tick_s;
    if (++drive.ticks == scored.drive_ticks) {
      drive.sigma_rad = std::hypot(node.heading_sigma_rad(), std::sqrt(white_rad2));
    }
  });
  // A drive that lost ticks, or that the record ends in, says something else.
  std::erase_if(all, [&](const ScoredDrive& d) { return d.ticks != scored.drive_ticks; });
  return all;
}

/// Calls `run` with the model of the node, of the shape that the model takes.
template <class Run>
auto with_node_model(const model::SensorModel& model, const ScoredTicks& ticks, Run run) try {
  return model::with_shape_of<model::kLargestShape>(model, [&]<core::ModelShape Shape>() {
    return run(model::make_node_model<Shape>(model, ticks.sample_period, ticks.tick));
  });
} catch (const std::invalid_argument& reason) {
  throw ModelCannotRun(reason.what());
}

}  // namespace

ScoreOf level_of(const model::SensorModel& model) {
  return model.quantization || model.outliers || model.motion_contamination ||
                 model.variable_noise || model.saturation
             ? ScoreOf::samples
             : ScoreOf::tick_means;
}

std::vector<ScoredDrive> score_drives(const model::SensorModel& model, const ScoredTicks& ticks) {
  return with_node_model(model, ticks, [&](const auto& node) { return drives(node, ticks); });
}

NodeScores score(const model::SensorModel& model, const ScoredTicks& ticks, ScoreOf what) {
  return with_node_model(model, ticks, [&](const auto& node) {
    return NodeScores{drives(node, ticks), log_scores(node, ticks, what)};
  });
}

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLeastProbability = 1e-300;

struct Interval {
  double from;
  double to;
};

/// One of the things that the sample may be: normal, with the share that it has of all.
struct Component {
  double share;
  double mean;
  double variance;

  [[nodiscard]] double density(double rate) const {
    const double off = rate - mean;
    return share * std::exp(-0.5 * off * off / variance) /
           std::sqrt(2.0 * std::numbers::pi * variance);
  }
  [[nodiscard]] double mass(const Interval& interval) const {
    const double unit = std::sqrt(2.0 * variance);
    double from = (interval.from - mean) / unit;
    double to = (interval.to - mean) / unit;
    if (from < 0.0 && to < 0.0) {  // in the upper tail nothing cancels
      std::swap(from, to);
      from = -from;
      to = -to;
    }
    return share * 0.5 * (std::erfc(from) - std::erfc(to));
  }
};

/// Sum of the density over the levels, times the step: 1 unless the levels are far apart.
double sum_over_levels(const std::array<Component, 3>& parts, double level, double step) {
  const double sigma = std::sqrt(parts.front().variance);
  if (step < sigma) return 1.0;  // to 1e-8
  constexpr double kReach = 8.0;
  const double middle = std::round((parts.front().mean - level) / step);
  const double reach = std::ceil(kReach * sigma / step);
  double sum = 0.0;
  for (double n = middle - reach; n <= middle + reach; n += 1.0) {
    for (const Component& part : parts) sum += step * part.density(level + n * step);
  }
  return std::max(sum, kLeastProbability);
}

/// @param rounding  variance that is not noise but of rounding, less than there is
std::array<Component, 3> components(const core::SampleScreen::Forecast& forecast, double rounding) {
  const double mean = double{forecast.expected_rad_s};
  const double all = double{forecast.variance};
  const double narrow = all - rounding;
  const double moved = double{forecast.moved};
  const double outlier = (1.0 - moved) * double{forecast.outlier};
  return {
      {{1.0 - moved - outlier, mean, narrow},
       {outlier, mean, narrow + double{forecast.outlier_variance}},
       {moved, mean + double{forecast.offset_rad_s}, narrow + double{forecast.offset_variance}}}};
}

}  // namespace

double log_score(const core::SampleScreen::Forecast& forecast, double reading_rad_s,
                 const Scale& scale) {
  const double half = 0.5 * scale.step_rad_s;
  auto parts = components(forecast, scale.rounding_variance);
  if (half > 0.0) {
    Component& undisturbed = parts.front();
    const double step = scale.step_rad_s;
    const statistics::MeanBeforeRounding mean_before_rounding(std::sqrt(undisturbed.variance) /
                                                              step);
    undisturbed.mean =
        reading_rad_s + step * mean_before_rounding((undisturbed.mean - reading_rad_s) / step);
  }
  double sum = 0.0;
  if (!scale.range.is_saturated(static_cast<float>(reading_rad_s)) && half == 0.0) {
    for (const Component& part : parts) sum += part.density(reading_rad_s);
    const double levels = sum_over_levels(parts, reading_rad_s, scale.unknown_step_rad_s);
    return std::log(std::max(sum, kLeastProbability) / levels);
  }
  Interval cell{reading_rad_s - half, reading_rad_s + half};
  if (reading_rad_s >= double{scale.range.upper_rad_s}) cell.to = kInfinity;
  if (reading_rad_s <= double{scale.range.lower_rad_s}) cell.from = -kInfinity;
  for (const Component& part : parts) sum += part.mass(cell);
  const double width = half > 0.0 ? scale.step_rad_s : scale.end_cell_rad_s;
  return std::log(std::max(sum, kLeastProbability) / width);
}

}  // namespace zerorate::diagnose
