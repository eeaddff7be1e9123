#include <fmt/format.h>

#include <cmath>
#include <numeric>

#include "host_tools/lib/diagnose/effects/effects.hpp"
#include "host_tools/lib/diagnose/effects/spectral.hpp"

namespace zerorate::diagnose {
namespace {

/// Of the white noise: finer steps are those of a number format and change nothing.
constexpr double kFinest = 0.05;

/// Rates that come in steps. The part's shape: the step in rad/s.
class Quantization final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "quantization"; }

  [[nodiscard]] std::optional<Offer> examine(const Explanation& without) const override {
    const auto& lattice = without.problem().lattice();
    if (!lattice || lattice->step * std::sqrt(without.information()) < kFinest) return std::nullopt;
    // A value without steps would lie within a tenth of a step from a level one time in five.
    const std::size_t values =
        std::accumulate(lattice->counts.begin(), lattice->counts.end(), std::size_t{0});
    const double gain = static_cast<double>(values - lattice->counts.size()) * std::log(5.0);
    return Offer{{.effect = name(), .shape = {lattice->step}}, gain, gain};
  }

  [[nodiscard]] Account tell(const Found& found) const override {
    const double step = found.part().shape[0] * kDegPerRad;
    const double sigma = found.part().shape[0] * std::sqrt(found.all.information());
    // The lattice spans many steps, each known to the tenth that it was found with.
    const double error = 1e-4 * step;
    return {
        .parameters = {parameter("step_dps", step, error)},
        .sentence = fmt::format("The rate comes in steps of {:.3g} deg/s, {:.2g} times the white "
                                "noise of a sample.",
                                step, sigma)};
  }

  void extend(const Found& found, model::SensorModel& model) const override {
    const double step = found.part().shape[0];
    model.quantization = model::Quantization{.step_rad_s = step};
    // The node adds step^2 / 12 itself; the noise was fitted with it.
    const double period_s = found.all.problem().period_s();
    double& white = model.white.angle_random_walk_rad_per_sqrt_s;
    const double variance = white * white - step * step / 12.0 * period_s;
    constexpr double kLeastShare = 0.05;
    white = std::sqrt(std::max(variance, kLeastShare * white * white));
  }
};

}  // namespace

std::unique_ptr<Effect> make_quantization() {
  return std::make_unique<Quantization>();
}

}  // namespace zerorate::diagnose
