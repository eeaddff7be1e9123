#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "host_tools/lib/diagnose/effects/effects.hpp"
#include "host_tools/lib/diagnose/effects/mean_scan.hpp"
#include "host_tools/lib/diagnose/effects/spectral.hpp"
#include "host_tools/lib/diagnose/surprise.hpp"
#include "host_tools/lib/spectrum/real_fft.hpp"

namespace zerorate::diagnose {
namespace {

constexpr double kFewestCycles = 1.5;
constexpr std::size_t kPadding = 4;

/// A line in the spectrum: a sine of constant frequency, amplitude and phase. The part's shape: its
/// frequency in Hz. Its columns: cosine and sine.
class PeriodicDisturbance final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "periodic_disturbance"; }

  [[nodiscard]] std::optional<Offer> examine(const Explanation& without) const override {
    std::optional<Offer> offer =
        offer_of_mean(without, [this](const MeanScan& scan) { return search(scan); });
    if (!offer) return offer;
    const double gain = std::max(offer->gain_nats, 1.0);
    const double bins = 0.5 * static_cast<double>(without.problem().size());
    offer->surprise_nats =
        surprise_of_search(offer->gain_nats, 2.0, bins * std::sqrt(std::numbers::pi * gain / 3.0));
    return offer;
  }

  [[nodiscard]] Account tell(const Found& found) const override {
    const double a = found.amplitude(0);
    const double b = found.amplitude(1);
    const double amplitude = std::hypot(a, b) * kDegPerRad;
    const double error =
        std::hypot(a * found.amplitude_error(0), b * found.amplitude_error(1)) / std::hypot(a, b);
    const double frequency = found.part().shape.front();
    const double rad_per_s = 2.0 * std::numbers::pi * frequency;
    const Column derivative = fast_column_of(found.all.problem(), [&](double time_s) {
      const double turn = rad_per_s * time_s;
      return 2.0 * std::numbers::pi * time_s * (b * std::cos(turn) - a * std::sin(turn));
    });
    return {.parameters = {parameter("amplitude_dps", amplitude, error * kDegPerRad),
                           parameter("frequency_hz", frequency, shape_error(found, derivative))},
            .sentence = fmt::format("A sine of {:.2g} deg/s at {:.5g} Hz (or an alias of it) is in "
                                    "the rate: vibration, a supply, a beat.",
                                    amplitude, frequency),
            .drawing = drawing_of(found)};
  }

  void extend(const Found& found, model::SensorModel& model) const override {
    const double amplitude = std::hypot(found.amplitude(0), found.amplitude(1));
    model.harmonic.push_back({.rms_rad_s = amplitude / std::numbers::sqrt2,
                              .frequency_hz = found.part().shape.front(),
                              .coherence_time_s = found.all.problem().span_s()});
  }

 private:
  [[nodiscard]] std::optional<Part> search(const MeanScan& scan) const {
    const Problem& problem = scan.problem();
    const std::size_t n = problem.size();
    const spectrum::RealFft fft(kPadding * n);
    std::vector<double> padded(fft.length());
    std::ranges::copy(scan.weighted(), padded.begin());
    std::vector<std::complex<double>> bins(fft.bins());
    fft.forward(padded, bins);
    const auto gain = [&](std::size_t j) {
      const std::size_t k = std::clamp<std::size_t>(2 * j / kPadding, 1, n - 1);
      return std::norm(bins[j]) * scan.density()[k] / static_cast<double>(n);
    };
    const auto first = static_cast<std::size_t>(kFewestCycles * static_cast<double>(kPadding));
    std::size_t best = first;
    for (std::size_t j = first; j + 2 < bins.size(); ++j) {
      if (gain(j) > gain(best)) best = j;
    }
    // The vertex of the parabola through three points.
    const double left = gain(best - 1);
    const double right = gain(best + 1);
    const double bend = left - 2.0 * gain(best) + right;
    const double offset = bend < 0.0 ? std::clamp(0.5 * (left - right) / bend, -1.0, 1.0) : 0.0;
    const double cycles = (static_cast<double>(best) + offset) / static_cast<double>(kPadding * n);
    const double frequency_hz = cycles / problem.period_s();
    const double rad_per_s = 2.0 * std::numbers::pi * frequency_hz;
    return Part{.effect = name(),
                .columns = {fast_column_of(problem,
                                           [&](double t) { return std::cos(rad_per_s * t); }),
                            fast_column_of(problem,
                                           [&](double t) { return std::sin(rad_per_s * t); })},
                .shape = {frequency_hz}};
  }
};

}  // namespace

std::unique_ptr<Effect> make_periodic_disturbance() {
  return std::make_unique<PeriodicDisturbance>();
}

}  // namespace zerorate::diagnose
