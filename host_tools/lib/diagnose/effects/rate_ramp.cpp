#include <fmt/format.h>

#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/diagnose/effects/mean_effect.hpp"
#include "host_tools/lib/diagnose/effects/spectral.hpp"
#include "host_tools/lib/statistics/search_significance.hpp"

namespace zerorate::diagnose {
namespace {

/// A bias that changes at a constant rate. Its column is the time in s.
class RateRamp final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "rate_ramp"; }

  [[nodiscard]] std::optional<Offer> examine(const Explanation& without) const override {
    std::optional<Offer> offer = offer_of_mean(without, [this](const MeanScan& scan) {
      return Part{.effect = name(),
                  .columns = {column_of(scan.problem(), [](double time_s) { return time_s; })}};
    });
    offer->surprise_nats = statistics::surprise_of_free(offer->gain_nats, 1.0);
    return offer;
  }

  [[nodiscard]] Account tell(const Found& found) const override {
    const double slope = found.amplitude(0) * kDegPerRad;
    return {
        .parameters = {parameter("slope_dps_per_s", slope, found.amplitude_error(0) * kDegPerRad)},
        .sentence = fmt::format("The bias changes steadily by {:.3g} deg/s an hour, {:.3g} deg/s "
                                "over the recording.",
                                3600.0 * slope, slope * found.all.problem().span_s()),
        .drawing = drawing_of(found)};
  }

  /// The next start may have another slope, so the interval is wider than that of this record.
  void extend(const Found& found, model::SensorModel& model) const override {
    const double slope = found.amplitude(0);
    model.rate_ramp = model::RateRamp{
        .slope_rad_s2 = slope,
        .slope_sigma_rad_s2 = std::hypot(found.amplitude_error(0), kShareOfNextStart * slope)};
  }
};

}  // namespace

std::unique_ptr<Effect> make_rate_ramp() {
  return std::make_unique<RateRamp>();
}

}  // namespace zerorate::diagnose
