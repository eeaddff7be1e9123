#include <fmt/format.h>

#include <cmath>

#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/diagnose/effects/spectral.hpp"
#include "host_tools/lib/statistics/search_significance.hpp"

namespace zerorate::diagnose {
namespace {

/// A first-order Gauss-Markov process: exponentially correlated noise.
class CorrelatedNoise final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "correlated_noise"; }

  [[nodiscard]] std::optional<Offer> examine(const Explanation& without) const override {
    if (without.terms().gauss_markov) return std::nullopt;
    Part part{.effect = name(), .terms = {.gauss_markov = true}};
    const NoiseSpectrum& noise = without.noise().spectrum;
    const auto size = static_cast<double>(without.problem().size());
    for (double samples = 1.5; samples < 0.2 * size; samples *= 8.0) {
      NoiseSpectrum start = noise;
      start.markov_samples = samples;
      // As strong as the rest at its corner.
      start.markov_variance =
          0.5 * noise.density(1.0 / samples, 0, without.problem().size()) / samples;
      part.starts.push_back(start);
    }
    Offer offer = offer_with(without, std::move(part));
    offer.surprise_nats =
        statistics::surprise_of_search(offer.gain_nats, 1.0, 0.1 * std::log(size));
    return offer;
  }

  [[nodiscard]] Account tell(const Found& found) const override {
    const NoiseErrors& errors = found.all.noise().errors;
    const double sigma = sigma_rad_s(found) * kDegPerRad;
    const double time_constant = time_constant_s(found);
    return {.parameters = {positive_parameter("sigma_dps", sigma, 0.5 * errors.log_markov_variance),
                           positive_parameter("time_constant_s", time_constant,
                                              errors.log_markov_samples)},
            .sentence = fmt::format("Noise of {:.2g} deg/s (rms) is correlated over {:.3g} s "
                                    "(Gauss-Markov).",
                                    sigma, time_constant)};
  }

  void extend(const Found& found, model::SensorModel& model) const override {
    model.gauss_markov.push_back(
        {.sigma_rad_s = sigma_rad_s(found), .time_constant_s = time_constant_s(found)});
  }

 private:
  static double sigma_rad_s(const Found& found) {
    return std::sqrt(found.all.noise().spectrum.markov_variance);
  }
  static double time_constant_s(const Found& found) {
    return found.all.noise().spectrum.markov_samples * found.all.problem().period_s();
  }
};

}  // namespace

std::unique_ptr<Effect> make_correlated_noise() {
  return std::make_unique<CorrelatedNoise>();
}

}  // namespace zerorate::diagnose
