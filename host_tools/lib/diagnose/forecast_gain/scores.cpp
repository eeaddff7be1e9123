#include "host_tools/lib/diagnose/forecast_gain/scores.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/samples/sample_screen.hpp"
#include "firmware/app/tick_forecast.hpp"
#include "firmware/app/tick_node.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tools/lib/diagnose/forecast_gain/reading_score.hpp"

namespace zerorate::diagnose {
namespace {

constexpr app::NodeCapacity kCapacity{.axes = 1,
                                      .screens_samples = true,
                                      .runs_moving_average = false,
                                      .runs_calibration_mean = false};

/// app::TickNode with the ticks of a record.
template <core::ModelShape Shape>
class TickRun {
 public:
  using Node = app::TickNode<Shape, kCapacity>;
  using Params = typename Node::Params;

  TickRun(const Params& params, const ScoredTicks& ticks)
      : params_(params), ticks_(ticks), node_(params) {}
  TickRun(const TickRun& other)
      : params_(other.params_),
        ticks_(other.ticks_),
        node_(other.params_),
        next_(other.next_),
        first_sample_(other.first_sample_),
        stood_(other.stood_) {
    node_.restore(other.node_.state());
  }
  TickRun& operator=(const TickRun&) = delete;
  ~TickRun() = default;

  [[nodiscard]] bool is_over() const { return next_ == ticks_.ticks.size(); }
  [[nodiscard]] const identify::TickMean& tick() const { return ticks_.ticks[next_]; }
  [[nodiscard]] const Node& node() const { return node_; }

  /// Goes on to the tick.
  void enter() {
    node_.begin_tick(tick().tick);
    if (ticks_.temperature_degc.empty()) {
      node_.inputs().take(begin(), true, std::numeric_limits<float>::quiet_NaN());
      return;
    }
    for (std::uint32_t k = 0; k < tick().samples; ++k) {
      node_.inputs().take(begin() + ticks_.sample_period * std::int64_t{k}, k == 0,
                          static_cast<float>(ticks_.temperature_degc[first_sample_ + k]));
    }
  }
  /// Bias that is predicted for the tick.
  [[nodiscard]] core::Prediction predict() {
    node_.finish();
    return node_.predicted()[0];
  }
  /// The tick belongs to a drive.
  void pass() {
    stood_ = false;
    node_.end_stop();
    go_on();
  }
  /// Learns from the mean of the tick.
  core::Innovation learn_mean() { return learn(tick().rate_rad_s[0], tick().samples); }
  /// Learns from the samples of the tick that the node does not leave out. Calls visit(forecast,
  /// rate) for every sample of which there is a forecast.
  template <class Visit>
  void learn_samples(Visit visit) {
    if (!predict().is_available()) {
      (void)learn_mean();
      return;
    }
    node_.begin_samples();
    double sum = 0.0;
    std::uint32_t learnt = 0;
    for (const double rate : ticks_.rate_rad_s.subspan(first_sample_, tick().samples)) {
      visit(node_.screening().screen(0).forecast(), rate);
      if (!node_.take({static_cast<float>(rate)})) continue;
      sum += rate;
      ++learnt;
    }
    if (learnt == 0) {
      go_on();
    } else {
      (void)learn(static_cast<float>(sum / static_cast<double>(learnt)), learnt);
    }
  }

  /// Variance of the mean of so many samples, whatever they are.
  [[nodiscard]] double measurement_variance(std::uint32_t samples) const {
    const core::SampleModel& model = params_.model.samples;
    float of_sample = node_.white_variance_rad2_s2(0);
    if (model.outliers.is_on()) of_sample += model.outliers.variance_in_sums();
    if (model.motion.is_on()) of_sample += model.motion.variance_in_sums();
    return double{of_sample / static_cast<float>(samples) +
                  params_.model.measurement_floor_variance_rad2_s2};
  }
  /// Heading sigma of the drive that began after the newest measurement and ends now.
  [[nodiscard]] double heading_sigma_rad() const {
    const app::TickForecast<Node> forecast{node_};
    const core::HeadingPrediction heading = forecast.predict_heading(
        app::Predictor::kalman, 0, node_.measured_ticks(), tick().tick + 1);
    return double{heading.sigma_rad()};
  }

 private:
  [[nodiscard]] core::Instant begin() const {
    return core::Instant{} + ticks_.tick * std::int64_t{tick().tick};
  }
  core::Innovation learn(float rate_rad_s, std::uint32_t samples) {
    typename Node::Tick measured = node_.measurement(
        {.tick = tick().tick, .samples = samples, .end = {}, .rate_rad_s = {rate_rad_s}});
    measured.begins_stop = !stood_;
    stood_ = true;
    go_on();
    return node_.learn_at_once(measured)[0];
  }
  void go_on() {
    first_sample_ += tick().samples;
    ++next_;
  }

  const Params& params_;
  const ScoredTicks& ticks_;
  Node node_;
  std::size_t next_ = 0;
  std::size_t first_sample_ = 0;
  bool stood_ = false;
};

/// Looks at every sample only where the model asks for it: the filter is the same otherwise.
template <core::ModelShape Shape>
void learn(TickRun<Shape>& run) {
  if (run.node().params().model.samples.needs_screen()) {
    run.learn_samples([](const auto& /*forecast*/, double /*rate*/) {});
  } else {
    (void)run.learn_mean();
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

/// Scores of the ticks that are left, all of them learnt from.
template <core::ModelShape Shape>
std::vector<double> log_scores(TickRun<Shape> run, const ScoredTicks& ticks, ScoreOf what) {
  const Scale scale = scale_of(run.node().params().model, ticks.level_step_rad_s);
  std::vector<double> scores;
  scores.reserve(ticks.ticks.size());
  while (!run.is_over()) {
    run.enter();
    double sum = 0.0;
    if (what == ScoreOf::samples) {
      run.learn_samples(
          [&](const auto& forecast, double rate) { sum += log_score(forecast, rate, scale); });
    } else {
      const core::Innovation innovation = run.learn_mean();
      if (!innovation.first) sum = log_density(innovation);
    }
    scores.push_back(sum);
  }
  return scores;
}

/// Drives among the ticks that are left, which are stops and drives in turn.
template <core::ModelShape Shape>
std::vector<ScoredDrive> drives(TickRun<Shape> run, const ScoredTicks& ticks) {
  std::vector<ScoredDrive> all;
  const double tick_s = static_cast<double>(ticks.tick.ns()) * 1e-9;
  const std::uint32_t cycle = ticks.stop_ticks + ticks.drive_ticks;
  std::uint32_t drive_number = 0;
  double white_rad2 = 0.0;
  while (!run.is_over()) {
    run.enter();
    const identify::TickMean mean = run.tick();
    const std::uint32_t judged = mean.tick - ticks.judged_from;
    if (judged % cycle < ticks.stop_ticks) {
      learn(run);
      continue;
    }
    if (all.empty() || drive_number != judged / cycle) {
      drive_number = judged / cycle;
      all.emplace_back();
      white_rad2 = 0.0;
    }
    ScoredDrive& drive = all.back();
    const double error = double{mean.rate_rad_s[0]} - double{run.predict().bias_rad_s};
    drive.integrated_rad += error * tick_s;
    drive.squares_rad2_s2 += error * error;
    white_rad2 += run.measurement_variance(mean.samples) * tick_s * tick_s;
    if (++drive.ticks == ticks.drive_ticks) {
      drive.sigma_rad = std::hypot(run.heading_sigma_rad(), std::sqrt(white_rad2));
    }
    run.pass();
  }
  // A drive that lost ticks, or that the record ends in, is another drive.
  std::erase_if(all, [&](const ScoredDrive& d) { return d.ticks != ticks.drive_ticks; });
  return all;
}

/// Calls `use` with a run that has learnt everything up to where the model is judged.
template <core::ModelShape Largest, class Use>
auto with_learnt_run(const model::SensorModel& model, const ScoredTicks& ticks, Learning learning,
                     Use use) try {
  return model::with_shape_of<Largest>(model, false, [&]<core::ModelShape Shape>() {
    const app::NodeParams<Shape> params{
        .model = model::make_node_model<Shape>(model, ticks.sample_period, ticks.tick),
        .learns_white_noise = learning == Learning::on};
    TickRun<Shape> run{params, ticks};
    while (!run.is_over() && run.tick().tick < ticks.judged_from) {
      run.enter();
      learn(run);
    }
    return use(run);
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
  return with_learnt_run<model::kLargestShape>(model, ticks, Learning::off,
                                               [&](const auto& run) { return drives(run, ticks); });
}

NodeScores score(const model::SensorModel& model, const ScoredTicks& ticks, ScoreOf what,
                 Learning learning) {
  const auto scores = [&](const auto& run) {
    return NodeScores{drives(run, ticks), log_scores(run, ticks, what)};
  };
  if (learning == Learning::on) {
    return with_learnt_run<model::kLargestLearningShape>(model, ticks, learning, scores);
  }
  return with_learnt_run<model::kLargestShape>(model, ticks, learning, scores);
}

}  // namespace zerorate::diagnose
