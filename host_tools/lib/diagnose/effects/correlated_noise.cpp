#include <fmt/format.h>

#include <cmath>

#include "host_tools/lib/diagnose/effects/candidates.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;

/// A first-order Gauss-Markov process: exponentially correlated noise.
class CorrelatedNoise final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "correlated_noise"; }
  [[nodiscard]] bool is_noise() const override { return true; }
  [[nodiscard]] Pace pace() const override { return Pace::either; }

  [[nodiscard]] Description describe(const FittedPart& fitted) const override {
    const SpectrumFit& noise = fitted.hypothesis.noise();
    const double sigma = sigma_rad_s(fitted) * kDegPerRad;
    const double time_constant = time_constant_s(fitted);
    return {.parameters = {positive_parameter("sigma_dps", sigma,
                                              0.5 * noise.error(NoiseParameterId::markov_variance)),
                           positive_parameter("time_constant_s", time_constant,
                                              noise.error(NoiseParameterId::markov_samples))},
            .sentence = fmt::format("Noise of {:.2g} deg/s (rms) is correlated over {} s "
                                    "(Gauss-Markov).",
                                    sigma, units::in_figures(time_constant))};
  }

  void add_to_model(const FittedPart& fitted, model::SensorModel& model) const override {
    model.gauss_markov.push_back(
        {.sigma_rad_s = sigma_rad_s(fitted), .time_constant_s = time_constant_s(fitted)});
  }

 private:
  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without) const override {
    if (without.terms().gauss_markov) return std::nullopt;
    Part part{.effect = name(), .terms = {.gauss_markov = true}};
    const NoiseSpectrum& noise = without.noise().spectrum;
    const auto size = static_cast<double>(without.data().size());
    for (double samples = 1.5; samples < 0.2 * size; samples *= 8.0) {
      NoiseSpectrum start = noise;
      start.markov_samples = samples;
      // Its strength at its corner is that of the rest.
      start.markov_variance =
          0.5 * noise.density(1.0 / samples, 0, without.data().size()) / samples;
      part.starts.push_back(start);
    }
    Candidate candidate = candidate_with(without, std::move(part));
    candidate.surprisal_nats =
        statistics::surprisal_of_search(candidate.gain_nats, 1.0, 0.1 * std::log(size));
    candidate.time_scale_s = candidate.noise.markov_samples * without.data().period_s();
    return candidate;
  }

  static double sigma_rad_s(const FittedPart& fitted) {
    return std::sqrt(fitted.hypothesis.noise().spectrum.markov_variance);
  }
  static double time_constant_s(const FittedPart& fitted) {
    return fitted.hypothesis.noise().spectrum.markov_samples * fitted.hypothesis.data().period_s();
  }
};

}  // namespace

std::unique_ptr<Effect> make_correlated_noise() {
  return std::make_unique<CorrelatedNoise>();
}

}  // namespace zerorate::diagnose
