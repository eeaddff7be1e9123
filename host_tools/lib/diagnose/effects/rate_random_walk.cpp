#include <fmt/format.h>

#include <cmath>

#include "host_tools/lib/diagnose/effects/candidates.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;

/// Density K^2 / (2 pi nu)^2 (IEEE Std 952): the bias walks at random.
class RateRandomWalk final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "rate_random_walk"; }
  [[nodiscard]] bool is_noise() const override { return true; }
  [[nodiscard]] Pace pace() const override { return Pace::slow; }

  [[nodiscard]] Description describe(const FittedPart& fitted) const override {
    const double coefficient = coefficient_rad_s_per_sqrt_s(fitted) * kDegPerRad;
    const double error = 0.5 * fitted.hypothesis.noise().error(NoiseParameterId::walk_variance);
    return {.parameters = {positive_parameter("coefficient_dps_per_sqrt_s", coefficient, error)},
            .sentence = fmt::format("The bias walks at random, by {:.2g} deg/s in a second and "
                                    "{:.2g} deg/s in an hour (rms).",
                                    coefficient, 60.0 * coefficient)};
  }

  void add_to_model(const FittedPart& fitted, model::SensorModel& model) const override {
    const double before =
        model.rate_random_walk ? model.rate_random_walk->coefficient_rad_s_per_sqrt_s : 0.0;
    model.rate_random_walk = model::RateRandomWalk{
        .coefficient_rad_s_per_sqrt_s = std::hypot(before, coefficient_rad_s_per_sqrt_s(fitted))};
  }

 private:
  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without) const override {
    if (without.terms().random_walk) return std::nullopt;
    Part part{.effect = name(), .terms = {.random_walk = true}};
    const NoiseSpectrum& noise = without.noise().spectrum;
    const FitData& data = without.data();
    for (const std::size_t index : {2U, 12U}) {
      const double sine = data.sines()[index];
      NoiseSpectrum start = noise;
      start.walk_variance = noise.density(sine, index, data.size()) * sine * sine;
      part.starts.push_back(start);
      start.flicker_variance *= 0.1;
      part.starts.push_back(start);
    }
    Candidate candidate = candidate_with(without, std::move(part));
    candidate.surprisal_nats = statistics::surprisal_of_strength(candidate.gain_nats);
    return candidate;
  }

  static double coefficient_rad_s_per_sqrt_s(const FittedPart& fitted) {
    return std::sqrt(fitted.hypothesis.noise().spectrum.walk_variance /
                     fitted.hypothesis.data().period_s());
  }
};

}  // namespace

std::unique_ptr<Effect> make_rate_random_walk() {
  return std::make_unique<RateRandomWalk>();
}

}  // namespace zerorate::diagnose
