#include <fmt/format.h>

#include "host_tools/lib/diagnose/effects/candidates.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;

/// A bias that changes at a constant rate. Its column is the time in s.
class RateRamp final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "rate_ramp"; }
  [[nodiscard]] Pace pace() const override { return Pace::slow; }

  [[nodiscard]] Description describe(const FittedPart& fitted) const override {
    const double slope = fitted.amplitude(0) * kDegPerRad;
    return {
        .parameters = {parameter("slope_dps_per_s", slope, fitted.amplitude_error(0) * kDegPerRad)},
        .sentence = fmt::format("The bias changes steadily by {:.3g} deg/s an hour, {:.3g} deg/s "
                                "over the recording.",
                                3600.0 * slope, slope * fitted.hypothesis.data().span_s()),
        .drawing = drawing_of(fitted)};
  }

  /// The next start may have another slope, so the interval is wider than that of this record.
  void add_to_model(const FittedPart& fitted, model::SensorModel& model) const override {
    const double slope = fitted.amplitude(0);
    model.rate_ramp = model::RateRamp{
        .slope_rad_s2 = slope,
        .slope_sigma_rad_s2 = std::hypot(fitted.amplitude_error(0), kShareOfNextStart * slope)};
  }

 private:
  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without) const override {
    std::optional<Candidate> candidate = mean_candidate(without, [this](const ColumnSearch& scan) {
      return Part{.effect = name(),
                  .columns = {column_of(scan.data(), [](double time_s) { return time_s; })}};
    });
    if (!candidate) return std::nullopt;
    candidate->surprisal_nats = statistics::surprisal_of_free(candidate->gain_nats, 1.0);
    return candidate;
  }
};

}  // namespace

std::unique_ptr<Effect> make_rate_ramp() {
  return std::make_unique<RateRamp>();
}

}  // namespace zerorate::diagnose
