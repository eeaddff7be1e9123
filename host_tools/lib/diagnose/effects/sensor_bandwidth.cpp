#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "host_tools/lib/diagnose/effects/candidates.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

/// Kinds of low-pass that are tried; the numbers are orders of Butterworth filters.
constexpr std::array<int, 5> kOrders = {NoiseSpectrum::kRecursive, NoiseSpectrum::kTwoNeighbours, 1,
                                        2, 4};

/// The variance that is added behind the sensor's filter: by rounding to the levels of the record.
/// Aliases and arithmetic fill up what the filter leaves below 2e-3 of the power; without them the
/// end of the spectrum would know the shape of a jump better than the jump.
double variance_behind_filter(const Hypothesis& hypothesis) {
  constexpr double kDeepest = 2e-3;
  const auto& lattice = hypothesis.data().lattice();
  const double step = lattice ? lattice->step : 0.0;
  return std::max(step * step / 12.0, kDeepest * hypothesis.noise().spectrum.white_variance);
}

/// The sensor's own low-pass on everything.
class SensorBandwidth final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "sensor_bandwidth"; }
  [[nodiscard]] bool is_noise() const override { return true; }
  [[nodiscard]] bool is_in_base() const override { return true; }

  [[nodiscard]] Description describe(const FittedPart& fitted) const override {
    const NoiseSpectrum& noise = fitted.hypothesis.noise().spectrum;
    const double error = fitted.hypothesis.noise().error(NoiseParameterId::low_pass_share);
    const double logit = statistics::logit(noise.low_pass_share);
    const auto cut_off = [&](double errors) {
      const double share = statistics::share_of_logit(logit + errors * error);
      return cut_off_hz(noise.filter_order, share, fitted.hypothesis.data().period_s());
    };
    return {
        .parameters = {{"cut_off_hz", cut_off(0.0), cut_off(-statistics::kHalfWidth95),
                        cut_off(statistics::kHalfWidth95)}},
        .sentence = fmt::format("The noise above {} Hz is cut off by a low-pass of order "
                                "{}, so that neighbouring samples are alike.",
                                units::in_figures(cut_off(0.0)), std::max(1, noise.filter_order))};
  }

  /// The filter receives means over its ticks, whose white noise is that below half their rate, and
  /// what rounding adds; where the model has steps the node adds that itself.
  void add_to_model(const FittedPart& fitted, model::SensorModel& model) const override {
    const FitData& data = fitted.hypothesis.data();
    const NoiseSpectrum& noise = fitted.hypothesis.noise().spectrum;
    const double highest = 0.5 * data.period_s() / node_tick_s(data);
    const double rounding = model.quantization ? 0.0 : noise.rounding_variance;
    const double kept = noise.white_variance * mean_gain(noise, highest) + rounding;
    model.white.angle_random_walk_rad_per_sqrt_s *=
        std::sqrt(kept / (noise.white_variance + rounding));
  }

 private:
  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without) const override {
    if (without.terms().low_pass) return std::nullopt;
    Candidate candidate = placed_candidate(
        without, {.effect = name(), .terms = {.low_pass = true}, .starts = starts_from(without)});
    const double search = std::log(static_cast<double>(kOrders.size()));
    candidate.surprisal_nats =
        std::max(0.0, statistics::surprisal_of_strength(candidate.gain_nats) - search);
    return candidate;
  }

  /// One start for each kind of filter.
  static std::vector<NoiseSpectrum> starts_from(const Hypothesis& without) {
    constexpr double kLeastShare = 0.1;
    const std::vector<SpectralBin> bins = bin_coefficients(without.residual());
    std::vector<NoiseSpectrum> starts;
    for (const int order : kOrders) {
      std::vector<NoiseSpectrum> of_order;
      for (const double share : {0.9, 0.5, 0.2, 0.06}) {
        NoiseSpectrum start = without.noise().spectrum;
        start.low_pass_share = share;
        start.filter_order = order;
        start.rounding_variance = variance_behind_filter(without);
        start.white_variance = std::max(start.white_variance - start.rounding_variance,
                                        kLeastShare * start.white_variance);
        of_order.push_back(start);
        if (order != NoiseSpectrum::kRecursive) continue;
        start.white_variance += start.flicker_variance;
        start.flicker_variance *= 0.1;
        of_order.push_back(start);
      }
      starts.push_back(likeliest_of(of_order, bins, without.data().size()));
    }
    return starts;
  }

  /// Where the power is half of what it was. Where that need not be below half the sample rate,
  /// that of the resistor and capacitor that y += a (x - y) stands for; of two neighbours those of
  /// the a that makes neighbours as alike: their correlation is 1 - a there.
  static double cut_off_hz(int order, double share, double period_s) {
    if (order > 0) return 0.5 * share / period_s;
    if (order == NoiseSpectrum::kTwoNeighbours) {
      share = 1.0 - 0.5 * (1.0 - share) / (1.0 + share);
    }
    return -std::log1p(-share) / (2.0 * std::numbers::pi * period_s);
  }

  /// Mean gain of the power between 0 and a frequency in cycles a sample.
  static double mean_gain(const NoiseSpectrum& noise, double highest) {
    constexpr int kNodes = 64;
    double sum = 0.0;
    for (int i = 0; i < kNodes; ++i) {
      const double frequency = highest * (i + 0.5) / kNodes;
      sum += noise.low_pass_gain(2.0 * std::sin(std::numbers::pi * frequency));
    }
    return sum / kNodes;
  }
};

}  // namespace

std::unique_ptr<Effect> make_sensor_bandwidth() {
  return std::make_unique<SensorBandwidth>();
}

}  // namespace zerorate::diagnose
