#include <fmt/format.h>

#include <cmath>

#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/diagnose/effects/spectral.hpp"
#include "host_tools/lib/statistics/search_significance.hpp"

namespace zerorate::diagnose {
namespace {

/// Density K^2 / (2 pi nu)^2 (IEEE Std 952): the bias walks at random.
class RateRandomWalk final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "rate_random_walk"; }

  [[nodiscard]] std::optional<Offer> examine(const Explanation& without) const override {
    if (without.terms().random_walk) return std::nullopt;
    Part part{.effect = name(), .terms = {.random_walk = true}};
    const NoiseSpectrum& noise = without.noise().spectrum;
    const Problem& problem = without.problem();
    for (const std::size_t index : {2U, 12U}) {
      const double sine = problem.sines()[index];
      NoiseSpectrum start = noise;
      start.walk_variance = noise.density(sine, index, problem.size()) * sine * sine;
      part.starts.push_back(start);
      start.flicker_variance *= 0.1;
      part.starts.push_back(start);
    }
    Offer offer = offer_with(without, std::move(part));
    offer.surprise_nats = statistics::surprise_of_strength(offer.gain_nats);
    return offer;
  }

  [[nodiscard]] Account tell(const Found& found) const override {
    const double coefficient = coefficient_rad_s_per_sqrt_s(found) * kDegPerRad;
    const double error = 0.5 * found.all.noise().errors.log_walk_variance;
    return {.parameters = {positive_parameter("coefficient_dps_per_sqrt_s", coefficient, error)},
            .sentence = fmt::format("The bias walks at random, by {:.2g} deg/s in a second and "
                                    "{:.2g} deg/s in an hour (rms).",
                                    coefficient, 60.0 * coefficient)};
  }

  void extend(const Found& found, model::SensorModel& model) const override {
    const double before =
        model.rate_random_walk ? model.rate_random_walk->coefficient_rad_s_per_sqrt_s : 0.0;
    model.rate_random_walk = model::RateRandomWalk{
        .coefficient_rad_s_per_sqrt_s = std::hypot(before, coefficient_rad_s_per_sqrt_s(found))};
  }

 private:
  static double coefficient_rad_s_per_sqrt_s(const Found& found) {
    return std::sqrt(found.all.noise().spectrum.walk_variance / found.all.problem().period_s());
  }
};

}  // namespace

std::unique_ptr<Effect> make_rate_random_walk() {
  return std::make_unique<RateRandomWalk>();
}

}  // namespace zerorate::diagnose
