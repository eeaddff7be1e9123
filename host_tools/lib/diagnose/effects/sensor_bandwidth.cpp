#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "host_tools/lib/diagnose/effects/effects.hpp"
#include "host_tools/lib/diagnose/effects/spectral.hpp"
#include "host_tools/lib/diagnose/surprise.hpp"
#include "host_tools/lib/identify/characterize.hpp"

namespace zerorate::diagnose {
namespace {

/// The sensor's own low-pass of first order on everything.
class SensorBandwidth final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "sensor_bandwidth"; }

  [[nodiscard]] std::optional<Offer> examine(const Explanation& without) const override {
    if (without.terms().low_pass) return std::nullopt;
    Part part{.effect = name(), .terms = {.low_pass = true}};
    for (const double share : {0.9, 0.6, 0.25, 0.06}) {
      NoiseSpectrum start = without.noise().spectrum;
      start.low_pass_share = share;
      part.starts.push_back(start);
      start.white_variance += start.flicker_variance;
      start.flicker_variance *= 0.1;
      part.starts.push_back(start);
    }
    Offer offer = offer_with(without, std::move(part));
    offer.surprise_nats = surprise_of_strength(offer.gain_nats);
    return offer;
  }

  [[nodiscard]] Account tell(const Found& found) const override {
    const double share = found.all.noise().spectrum.low_pass_share;
    const double error = found.all.noise().errors.logit_low_pass_share;
    const double logit = std::log(share / (1.0 - share));
    const double cut_off = cut_off_hz(found, logit);
    return {.parameters = {{"cut_off_hz", cut_off, cut_off_hz(found, logit - 1.96 * error),
                            cut_off_hz(found, logit + 1.96 * error)}},
            .sentence = fmt::format("The noise above {:.3g} Hz is cut off by a low-pass, so that "
                                    "neighbouring samples are alike.",
                                    cut_off)};
  }

  /// The filter sees means over its ticks, whose white noise is that below half their rate: the
  /// mean of 1 / (1 + (f / f_c)^2) up to f is atan(f / f_c) f_c / f.
  void extend(const Found& found, model::SensorModel& model) const override {
    const Problem& problem = found.all.problem();
    const auto nanoseconds = [](double seconds) {
      return core::Duration::nanoseconds(std::llround(seconds * 1e9));
    };
    const core::Duration tick = identify::identification_tick(nanoseconds(problem.span_s()),
                                                              nanoseconds(problem.period_s()));
    const double share = found.all.noise().spectrum.low_pass_share;
    const double ratio = 0.5 / (static_cast<double>(tick.ns()) * 1e-9) /
                         cut_off_hz(found, std::log(share / (1.0 - share)));
    model.white.angle_random_walk_rad_per_sqrt_s *= std::sqrt(std::atan(ratio) / ratio);
  }

 private:
  static double cut_off_hz(const Found& found, double logit) {
    const double kept = 1.0 / (1.0 + std::exp(logit));
    return -std::log(kept) / (2.0 * std::numbers::pi * found.all.problem().period_s());
  }
};

}  // namespace

std::unique_ptr<Effect> make_sensor_bandwidth() {
  return std::make_unique<SensorBandwidth>();
}

}  // namespace zerorate::diagnose
