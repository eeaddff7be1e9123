#include "firmware/model/hypotheses.hpp"

#include <array>
#include <cmath>
#include <span>

namespace zerorate::model {
namespace {

/// Angular frequency at which all orders have the amplitude of the model [rad/s].
constexpr double kPivot_rad_s = 1.0 / 30.0;
/// Amplitudes that an order is tried with, in equal steps of their logarithm, as distances from the
/// middle of the prior in standard deviations.
struct Row {
  double order;  ///< likewise, or d itself of the walk
  double lowest;
  double step;
  int count;
};
/// Two orders, of which one is that of the textbook by the default prior, 1/2. A mixture of two
/// amplitudes that lie far apart has more than the variance of a truth in between. So the
/// amplitudes of one order lie in the middle between those of the other.
constexpr std::array kRows{Row{-1.0, -1.225, 0.75, 4}, Row{0.5, -1.6, 0.75, 5}};
/// The steepest noise that lags can make: a random walk, as nearly as an order below 1 has it. It
/// is the only one that does not expect a bias that has moved far to return, and has nothing to say
/// of weak noise.
constexpr Row kWalk{0.99, 0.6, 0.8, 3};
constexpr std::array kRowOfFour{Row{0.0, -1.6, 0.9, 4}};
/// Logarithm of the prior of a walk over that of the middle order: one sensor in a thousand. A walk
/// that is likelier takes the motion of a rolling stop for its own.
constexpr double kLogPriorOfWalk = -7.0;
/// Gain of the logarithm of the prior by an amplitude one standard deviation larger: an interval
/// that is too narrow does more harm than one that is too wide.
constexpr double kCaution = 0.55;

/// Adds the amplitudes of an order d.
void add_row(const SensorModel& model, const Prior& prior, const Row& row, double order,
             double log_prior, std::vector<FlickerHypothesis>& hypotheses) {
  for (int i = 0; i < row.count; ++i) {
    const double deviations = row.lowest + row.step * i;
    const double gain = std::pow(prior.amplitude_factor, deviations);
    FlickerHypothesis one{.flicker = *model.flicker};
    one.flicker.order = order;
    one.flicker.bias_instability_rad_s *=
        gain * std::pow(kPivot_rad_s, order - model.flicker->order);
    one.level = gain * gain;
    one.log_prior = kCaution * deviations + log_prior;
    hypotheses.push_back(one);
  }
}

}  // namespace

std::vector<FlickerHypothesis> hypotheses_of(const SensorModel& model) {
  const int count = model.learning.value_or(Learning{}).hypotheses;
  if (!model.flicker || count == 1) return {};
  const Prior prior = model.prior.value_or(Prior{});
  const bool has_four = count == kRowOfFour[0].count;
  const std::span<const Row> rows =
      has_four ? std::span<const Row>{kRowOfFour} : std::span<const Row>{kRows};
  std::vector<FlickerHypothesis> hypotheses;
  for (const Row& row : rows) {
    add_row(model, prior, row, prior.order + row.order * prior.order_sigma,
            -0.5 * row.order * row.order, hypotheses);
  }
  if (!has_four) add_row(model, prior, kWalk, kWalk.order, kLogPriorOfWalk, hypotheses);
  return hypotheses;
}

}  // namespace zerorate::model
