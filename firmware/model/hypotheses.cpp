#include "firmware/model/hypotheses.hpp"

#include <array>
#include <cmath>
#include <span>

namespace zerorate::model {
namespace {

/// Angular frequency at which all orders have the amplitude of the model [rad/s].
constexpr double kPivot_rad_s = 1.0 / 30.0;
/// Distances from the middle of the prior, in standard deviations.
constexpr std::array kOrders{-1.0, 0.0, 1.0};
constexpr std::array kMiddleOrder{0.0};
constexpr std::array kAmplitudes{-1.6, -0.7, 0.2, 1.1};
/// Shift of the amplitudes of a neighbouring order, so that the grid has no wide meshes.
constexpr double kStagger = 0.3;
/// Gain of the logarithm of the prior by an amplitude one standard deviation larger: an interval
/// that is too narrow does more harm than one that is too wide.
constexpr double kCaution = 0.35;

}  // namespace

std::vector<FlickerHypothesis> hypotheses_of(const SensorModel& model) {
  const int count = model.learning.value_or(Learning{}).hypotheses;
  if (!model.flicker || count == 1) return {};
  const Prior prior = model.prior.value_or(Prior{});
  const bool is_of_one_order = count == static_cast<int>(kAmplitudes.size());
  const std::span<const double> orders =
      is_of_one_order ? std::span<const double>{kMiddleOrder} : std::span<const double>{kOrders};
  std::vector<FlickerHypothesis> hypotheses;
  for (const double of_order : orders) {
    for (const double of_amplitude : kAmplitudes) {
      const double deviations = of_amplitude + kStagger * of_order;
      const double gain = std::pow(prior.amplitude_factor, deviations);
      FlickerHypothesis one{.flicker = *model.flicker};
      one.flicker.order = prior.order + of_order * prior.order_sigma;
      one.flicker.bias_instability_rad_s *=
          gain * std::pow(kPivot_rad_s, one.flicker.order - model.flicker->order);
      one.level = gain * gain;
      one.log_prior = kCaution * deviations - 0.5 * of_order * of_order;
      hypotheses.push_back(one);
    }
  }
  return hypotheses;
}

}  // namespace zerorate::model
