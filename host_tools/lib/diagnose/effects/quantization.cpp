#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <numbers>
#include <numeric>

#include "host_tools/lib/diagnose/effects/candidates.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;

/// Finest step that counts, over the white noise: finer ones are a number format and change
/// nothing.
constexpr double kFinest = 0.05;

/// Rates that come in steps. The part's shape: the step in rad/s.
class Quantization final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "quantization"; }

  [[nodiscard]] std::string_view obstacle(const Hypothesis& without) const override {
    return without.data().series().is_ticks ? kUnevenSamples : std::string_view{};
  }

  [[nodiscard]] Description describe(const FittedPart& fitted) const override {
    const double step = fitted.part().shape[0] * kDegPerRad;
    const double sigma = fitted.part().shape[0] * std::sqrt(fitted.hypothesis.mean_precision());
    // The lattice spans many steps, each known to the tenth that it was found with.
    const double error = 1e-4 * step;
    return {
        .parameters = {parameter("step_dps", step, error)},
        .sentence = fmt::format("The rate comes in steps of {:.3g} deg/s, {:.2g} times the white "
                                "noise of a sample.",
                                step, sigma)};
  }

  void add_to_model(const FittedPart& fitted, model::SensorModel& model) const override {
    const double step = fitted.part().shape[0];
    model.quantization = model::Quantization{.step_rad_s = step};
    // The node adds step^2 / 12 itself; the noise was fitted with it.
    const double period_s = fitted.hypothesis.data().period_s();
    double& white = model.white.angle_random_walk_rad_per_sqrt_s;
    const double with_rounding = white * white;
    const double of_rounding = rounding_variance(fitted.hypothesis, step) * period_s;
    constexpr double kLeastShare = 0.05;
    white = std::sqrt(std::max(with_rounding - of_rounding, kLeastShare * with_rounding));
  }

 private:
  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without) const override {
    const auto& lattice = without.data().lattice();
    if (!lattice || lattice->step * std::sqrt(without.mean_precision()) < kFinest)
      return std::nullopt;
    // A value without steps would lie within a tenth of a step from a level one time in five.
    const std::size_t values =
        std::accumulate(lattice->counts.begin(), lattice->counts.end(), std::size_t{0});
    const double gain = static_cast<double>(values - lattice->counts.size()) * std::log(5.0);
    return Candidate{{.effect = name(), .shape = {lattice->step}}, gain, gain};
  }

  /// Variance that rounding adds to the values: step^2 / 12 where they reach over several
  /// levels; where they reach over few it depends on where between two levels the bias lies. So the
  /// spread before rounding is that which makes the levels most probable.
  static double rounding_variance(const Hypothesis& all, double step) {
    const double rounded = 1.0 / all.mean_precision();
    if (!all.is_coarse()) return step * step / 12.0;
    const auto cost = [&](double log_spread) {
      return -log_probability(all, step, std::exp(log_spread));
    };
    const double middle = 0.5 * std::log(rounded);
    constexpr int kBits = 20;
    const double spread = std::exp(
        boost::math::tools::brent_find_minima(cost, middle - 2.0, middle + 0.3, kBits).first);
    return rounded - spread * spread;
  }

  /// Log probability of the levels, each value predicted from all others; of long records a part.
  static double log_probability(const Hypothesis& all, double step, double spread) {
    constexpr std::size_t kMostValues = 20'000;
    const std::vector<double>& rate = all.data().rate_rad_s();
    const std::vector<double>& weighted = all.precision_weighted_residual();
    const double unit_of_weighted = -1.0 / (all.mean_precision() * step);
    const double unit = std::numbers::sqrt2 * spread / step;
    const statistics::MeanBeforeRounding mean_before_rounding(spread / step);
    double sum = 0.0;
    for (std::size_t k = 0; k < std::min(rate.size(), kMostValues); ++k) {
      if (all.is_replaced()[k]) continue;
      const double expected = unit_of_weighted * weighted[k];
      const double off = std::abs(mean_before_rounding(expected));
      const double mass = 0.5 * (std::erfc((off - 0.5) / unit) - std::erfc((off + 0.5) / unit));
      sum += std::log(std::max(mass, 1e-300));
    }
    return sum;
  }
};

}  // namespace

std::unique_ptr<Effect> make_quantization() {
  return std::make_unique<Quantization>();
}

}  // namespace zerorate::diagnose
