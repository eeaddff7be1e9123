#include "firmware/model/node_model.hpp"

#include <cmath>
#include <limits>

#include "core/base/numeric.hpp"
#include "core/noise/flicker.hpp"
#include "core/noise/gauss_markov.hpp"
#include "core/noise/harmonic.hpp"
#include "core/noise/random_walk.hpp"
#include "firmware/model/flicker_fit.hpp"
#include "firmware/model/validation.hpp"

namespace zerorate::model {
namespace {

using Decades = core::FlickerDecades<kMostDecaying - 1>;

double seconds(core::Duration duration) {
  return static_cast<double>(duration.ns()) * 1e-9;
}

/// A positive number below single precision's smallest normal one would lose its digits, one above
/// its greatest its value.
float single(double value) {
  const auto rounded = static_cast<float>(value);
  if (value != 0.0 && !std::isnormal(rounded)) {
    throw std::invalid_argument("a coefficient of the model is beyond single precision");
  }
  return rounded;
}

Decades decades_of(const FlickerFit& fit) {
  Decades decades;
  decades.time_constant_s.fill(1.0F);
  for (std::size_t i = 0; i < fit.time_constants_s.size(); ++i) {
    decades.time_constant_s[i] = single(fit.time_constants_s[i]);
    decades.variance_rad2_s2[i] = single(fit.variances_rad2_s2[i]);
  }
  return decades;
}

/// Squares of single-precision numbers may still overflow.
void require_finite(const core::Modes<kMostDecaying, kMostRotating>& modes) {
  bool finite = core::is_finite(modes.walk_variance);
  for (const auto& mode : modes.decaying) {
    finite = finite && core::is_finite(mode.noise_variance);
  }
  for (const auto& mode : modes.rotating) {
    finite = finite && core::is_finite(mode.noise_variance);
  }
  if (!finite) {
    throw std::invalid_argument("a variance of the model is beyond single precision");
  }
}

core::RandomWalk random_walk_of(const RateRandomWalk& walk) {
  return {.coefficient_rad_s_sqrt_s = single(walk.coefficient_rad_s_per_sqrt_s)};
}

core::GaussMarkov gauss_markov_of(const GaussMarkov& process) {
  return {.sigma_rad_s = single(process.sigma_rad_s),
          .time_constant_s = single(process.time_constant_s)};
}

core::Harmonic harmonic_of(const Harmonic& line) {
  return {.rms_rad_s = single(line.rms_rad_s),
          .frequency_hz = single(line.frequency_hz),
          .coherence_time_s = single(line.coherence_time_s)};
}

}  // namespace

NodeModel<kMostDecaying, kMostRotating> make_full_node_model(const SensorModel& model,
                                                             core::Duration sample_period,
                                                             core::Duration filter_tick) {
  validate(model);
  if (sample_period <= core::Duration{} || filter_tick < sample_period) {
    throw std::invalid_argument(
        "the sample period must be positive and not longer than the filter's tick");
  }
  const double tick_s = seconds(filter_tick);
  const double arw = model.white.angle_random_walk_rad_per_sqrt_s;
  double white_variance_of_tick = arw * arw / tick_s;
  Decades decades = decades_of({});
  if (model.flicker) {
    const FlickerFit fit = fit_flicker(*model.flicker, tick_s);
    decades = decades_of(fit);
    white_variance_of_tick += fit.white_variance_rad2_s2;
  }
  NodeModel<kMostDecaying, kMostRotating> node;
  node.modes = core::compose(
      filter_tick, model.node.start, decades,
      random_walk_of(model.rate_random_walk.value_or(RateRandomWalk{})),
      gauss_markov_of(model.gauss_markov.value_or(GaussMarkov{.time_constant_s = 1.0})),
      harmonic_of(model.harmonic.value_or(Harmonic{.coherence_time_s = 1.0})));
  require_finite(node.modes);
  node.white_variance_rad2_s2 = single(white_variance_of_tick * tick_s / seconds(sample_period));
  if (node.white_variance_rad2_s2 == 0.0F) {
    throw std::invalid_argument("the model \"" + model.name + "\" leaves no white noise");
  }
  return node;
}

}  // namespace zerorate::model
