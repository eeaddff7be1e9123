#include <fmt/format.h>

#include "host_tools/lib/diagnose/effects/candidates.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::diagnose {
namespace {

/// Flicker noise whose density falls like nu^(-2d) with another d than 1/2.
class FractionalOrder final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "fractional_order"; }
  [[nodiscard]] bool is_noise() const override { return true; }
  [[nodiscard]] Pace pace() const override { return Pace::slow; }
  [[nodiscard]] bool is_in_base() const override { return true; }

  [[nodiscard]] Description describe(const FittedPart& fitted) const override {
    const double order = fitted.hypothesis.noise().spectrum.flicker_order;
    const bool is_in_common = fitted.part().terms.given_order.has_value();
    const double error = is_in_common
                             ? fitted.part().shape.front()
                             : fitted.hypothesis.noise().error(NoiseParameterId::flicker_order);
    const std::string_view comparison =
        order > 0.5 ? "steeper than 1/f: the bias wanders farther over long times"
                    : "flatter than 1/f: the bias wanders less over long times";
    return {.parameters = {parameter("order", order, error)},
            .sentence = fmt::format("The flicker noise{} has the order d = {:.2f} (density ~ "
                                    "f^-{:.2f}), {}.",
                                    is_in_common ? " of all axes together" : "", order, 2.0 * order,
                                    comparison)};
  }

  /// The base model takes the order from the noise.
  void add_to_model(const FittedPart& /*fitted*/, model::SensorModel& /*model*/) const override {}

 private:
  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without) const override {
    if (without.terms().has_order()) return std::nullopt;
    Part part{.effect = name(), .terms = {.free_order = true}};
    const NoiseSpectrum& noise = without.noise().spectrum;
    const double pivot = without.data().sines()[without.data().size() / 64];
    for (const double order : {0.25, 0.4, 0.65, 0.85}) {
      NoiseSpectrum start = noise;
      start.flicker_order = order;
      start.flicker_variance *= std::pow(pivot, 2.0 * order - 1.0);
      part.starts.push_back(start);
    }
    Candidate candidate = candidate_with(without, std::move(part));
    candidate.surprisal_nats = statistics::surprisal_of_free(candidate.gain_nats, 1.0);
    return candidate;
  }
};

}  // namespace

std::unique_ptr<Effect> make_fractional_order() {
  return std::make_unique<FractionalOrder>();
}

}  // namespace zerorate::diagnose
