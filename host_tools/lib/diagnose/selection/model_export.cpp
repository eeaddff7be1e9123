#include "host_tools/lib/diagnose/selection/model_export.hpp"

#include <algorithm>
#include <cmath>

#include "host_tools/lib/spectrum/noise_strength.hpp"

namespace zerorate::diagnose {
namespace {

/// Weaker flicker noise than this share of the white noise at the lowest frequency is none.
constexpr double kNoFlicker = 1e-6;

}  // namespace

model::SensorModel model_of(const Hypothesis& hypothesis, std::span<const Choice> choices,
                            const std::string& source) {
  const NoiseSpectrum& noise = hypothesis.noise().spectrum;
  const double period_s = hypothesis.data().period_s();
  model::SensorModel model;
  model.name = source;
  const double white_variance = noise.white_variance + noise.rounding_variance;
  model.white = {spectrum::angle_random_walk(white_variance, period_s), "diagnosed from " + source};
  const double lowest = hypothesis.data().sines()[1];
  if (noise.flicker_variance * std::pow(lowest, -2.0 * noise.flicker_order) >
      kNoFlicker * noise.white_variance) {
    model.flicker = model::Flicker{.bias_instability_rad_s = spectrum::bias_instability(
                                       noise.flicker_variance, noise.flicker_order, period_s),
                                   .order = noise.flicker_order,
                                   .shortest_time_constant_s = std::max(0.5, 0.5 * period_s),
                                   .source = "diagnosed from " + source};
  }
  for (std::size_t i = 0; i < choices.size(); ++i) {
    choices[i].effect->add_to_model({hypothesis, i}, model);
  }
  return model;
}

}  // namespace zerorate::diagnose
