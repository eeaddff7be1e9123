#include "host_tools/lab/paper/figures.hpp"

#include <cmath>
#include <stdexcept>

#include "host_tools/lib/simulate/simulate.hpp"
#include "host_tools/lib/spectrum/noise_strength.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::paper {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kDphPerDps = 3600.0;
using units::kDphPerRadS;
using units::kRadSPerDph;

AllanCurve allan_curve(std::string name, std::vector<double> rate, double sample_period_s,
                       double dph_per_unit) {
  for (double& value : rate) value *= dph_per_unit;
  return {std::move(name), identify::allan_deviation(rate, sample_period_s)};
}

AllanCurve simulated_curve(std::string name, const std::vector<simulate::Effect>& effects,
                           std::uint64_t seed) {
  constexpr std::size_t kSamples = 1'000'000;
  auto signal = simulate::simulate(simulate::Signal(kSamples, 1.0), effects,
                                   random::RandomStream{seed}.substream(name));
  return allan_curve(std::move(name), std::move(signal.rate_rad_s), 1.0, kDphPerRadS);
}

std::vector<double> to_vector(const MatrixXd& column) {
  return {column.data(), column.data() + column.size()};
}

/// Completes a run that has everything but its predictions.
void predict(ExampleRun& run, const Predictors& predictors) {
  const auto calibration = static_cast<Index>(run.lengths.calibration);
  const Eigen::Map<const Eigen::VectorXd> samples{run.samples.data(),
                                                  static_cast<Index>(run.samples.size())};
  for (const auto& predictor : predictors) {
    const Forecasts forecasts = predictor->predict(samples.head(calibration));
    const Eigen::VectorXd error = samples.tail(samples.size() - calibration) - forecasts.bias;
    run.predictions.push_back({.name = predictor->name(),
                               .bias = to_vector(forecasts.bias),
                               .sigma = to_vector(forecasts.sigma),
                               .integrated_error = error.sum() * run.sample_period_s,
                               .rsse = error.norm()});
  }
}

}  // namespace

std::vector<AllanCurve> make_figure1(const std::vector<RestRecording>& recordings,
                                     std::uint64_t seed) {
  const double white = 45.0 * kRadSPerDph;
  const double flicker = 14.0 * kRadSPerDph;
  // K sqrt(tau / 3) meets the floor of the 1/f noise at 10^4 s.
  const double walk = spectrum::allan_floor(flicker) * std::sqrt(3.0 / 1e4);
  const simulate::WhiteNoise white_noise{.angle_random_walk_rad_rt_s = white};
  const simulate::FlickerNoise flicker_noise{.bias_instability_rad_s = flicker};
  std::vector<AllanCurve> curves;
  curves.push_back(
      simulated_curve("simulated, temperature-controlled", {white_noise, flicker_noise}, seed));
  curves.push_back(simulated_curve(
      "simulated, drifting",
      {white_noise, flicker_noise, simulate::RateRandomWalk{.rate_random_walk_rad_s_rt_s = walk}},
      seed));
  for (const RestRecording& recording : recordings) {
    for (std::size_t axis = 0; axis < recording.axes.size(); ++axis) {
      curves.push_back(allan_curve(recording.name + " " + "xyz"[axis], recording.axes[axis],
                                   recording.sample_period_s, kDphPerDps));
    }
  }
  return curves;
}

ExampleRun make_figure2(const SimulationOptions& options) {
  constexpr double kBias = 100.0;
  ExampleRun run{.source = "simulated by eq. 3, with a constant bias of 100",
                 .lengths = options.lengths};
  MatrixXd block(static_cast<Index>(options.lengths.total()), 1);
  simulated_sets(options.noise, options.seed)(0, block);
  run.samples = to_vector(block.array() + kBias);
  predict(run, simulated_predictors(options));
  return run;
}

ExampleRun make_figure3(const std::vector<RestRecording>& recordings,
                        const MeasuredOptions& options) {
  if (recordings.size() < 2) {
    throw std::invalid_argument(
        "figure 3 needs two recordings: one to predict, one to fit the noise on");
  }
  const RestRecording& recording = recordings[0];
  const RestRecording& other = recordings[1];
  const std::size_t axis = std::min(recording.axes.size(), other.axes.size()) - 1;
  const std::vector<double>& samples = recording.axes[axis];
  const FittedNoise noise = fit_noise(other, axis);
  if (std::abs(other.sample_period_s / recording.sample_period_s - 1.0) > 0.05 ||
      samples.size() < 2 * options.lengths.total() || !(noise.flicker.value > 0.0)) {
    throw std::invalid_argument(recording.name + " and " + other.name +
                                ": not of one rate, too short, or without detectable 1/f noise");
  }
  ExampleRun run{.source = recording.name + ", axis " + "xyz"[axis],
                 .unit = "deg/s",
                 .sample_period_s = recording.sample_period_s,
                 .lengths = options.lengths};
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  run.samples.assign(middle, middle + static_cast<std::ptrdiff_t>(options.lengths.total()));
  predict(run, measured_predictors(noise, options));
  return run;
}

}  // namespace zerorate::paper
