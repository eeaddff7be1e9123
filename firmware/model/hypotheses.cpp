#include "firmware/model/hypotheses.hpp"

#include <array>
#include <cmath>
#include <span>

namespace zerorate::model {
namespace {

/// Angular frequency at which all orders have the amplitude of the model [rad/s].
constexpr double kPivot_rad_s = 1.0 / 30.0;
/// Amplitudes that an order is tried with, in equal steps of their logarithm. Everything is a
/// distance from the middle of the prior, in standard deviations.
struct Row {
  double order;
  double lowest;
  double step;
  int count;
};
/// Two orders, of which one is that of the textbook by the default prior, 1/2. A third would cost
/// every other amplitude, and a mixture of two that lie far apart has more than the variance of a
/// truth in between. The amplitudes of one order lie in the middle between those of the other.
constexpr std::array kRows{Row{-1.0, -1.9, 0.6, 6}, Row{0.5, -1.6, 0.6, 6}};
constexpr std::array kRowOfFour{Row{0.0, -1.6, 0.9, 4}};
/// Gain of the logarithm of the prior by an amplitude one standard deviation larger: an interval
/// that is too narrow does more harm than one that is too wide.
constexpr double kCaution = 0.55;

}  // namespace

std::vector<FlickerHypothesis> hypotheses_of(const SensorModel& model) {
  const int count = model.learning.value_or(Learning{}).hypotheses;
  if (!model.flicker || count == 1) return {};
  const Prior prior = model.prior.value_or(Prior{});
  const std::span<const Row> rows =
      count == kRowOfFour[0].count ? std::span<const Row>{kRowOfFour} : std::span<const Row>{kRows};
  std::vector<FlickerHypothesis> hypotheses;
  for (const Row& row : rows) {
    for (int i = 0; i < row.count; ++i) {
      const double deviations = row.lowest + row.step * i;
      const double gain = std::pow(prior.amplitude_factor, deviations);
      FlickerHypothesis one{.flicker = *model.flicker};
      one.flicker.order = prior.order + row.order * prior.order_sigma;
      one.flicker.bias_instability_rad_s *=
          gain * std::pow(kPivot_rad_s, one.flicker.order - model.flicker->order);
      one.level = gain * gain;
      one.log_prior = kCaution * deviations - 0.5 * row.order * row.order;
      hypotheses.push_back(one);
    }
  }
  return hypotheses;
}

}  // namespace zerorate::model
