#include <fmt/format.h>

#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/diagnose/effects/spectral.hpp"
#include "host_tools/lib/statistics/search_significance.hpp"

namespace zerorate::diagnose {
namespace {

/// Flicker noise whose density falls like nu^(-2d) with another d than 1/2.
class FractionalOrder final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "fractional_order"; }

  [[nodiscard]] std::optional<Offer> examine(const Explanation& without) const override {
    if (without.terms().has_order()) return std::nullopt;
    Part part{.effect = name(), .terms = {.free_order = true}};
    const NoiseSpectrum& noise = without.noise().spectrum;
    const double pivot = without.problem().sines()[without.problem().size() / 64];
    for (const double order : {0.25, 0.4, 0.65, 0.85}) {
      NoiseSpectrum start = noise;
      start.order = order;
      start.flicker_variance *= std::pow(pivot, 2.0 * order - 1.0);
      part.starts.push_back(start);
    }
    Offer offer = offer_with(without, std::move(part));
    offer.surprise_nats = statistics::surprise_of_free(offer.gain_nats, 1.0);
    return offer;
  }

  [[nodiscard]] Account tell(const Found& found) const override {
    const double order = found.all.noise().spectrum.order;
    const bool is_in_common = found.part().terms.given_order.has_value();
    const double error = is_in_common ? found.part().shape.front() : found.all.noise().errors.order;
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
  void extend(const Found& /*found*/, model::SensorModel& /*model*/) const override {}
};

}  // namespace

std::unique_ptr<Effect> make_fractional_order() {
  return std::make_unique<FractionalOrder>();
}

}  // namespace zerorate::diagnose
