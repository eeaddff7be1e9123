#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "host_tools/lib/diagnose/effects/effects.hpp"
#include "host_tools/lib/diagnose/effects/mean_scan.hpp"
#include "host_tools/lib/diagnose/effects/spectral.hpp"
#include "host_tools/lib/diagnose/surprise.hpp"

namespace zerorate::diagnose {
namespace {

constexpr double kFewestCycles = 1.5;

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
    const std::vector<double> gains = line_gains(scan);
    const auto first = static_cast<std::ptrdiff_t>(2.0 * kFewestCycles);
    const auto best = std::max_element(gains.begin() + first, gains.end() - 1) - gains.begin();
    const double cycles = refined(scan.weighted(), 0.5 * static_cast<double>(best)) /
                          static_cast<double>(problem.size());
    auto [cosine, sine] = tone_columns(problem, cycles);
    return Part{.effect = name(),
                .columns = {std::move(cosine), std::move(sine)},
                .shape = {cycles / problem.period_s()}};
  }

  /// Of a line at k / 2n cycles a sample, for every k.
  static std::vector<double> line_gains(const MeanScan& scan) {
    // The cosine transform of (-1)^i x_i, read backwards, is the sine transform of x.
    const std::size_t n = scan.problem().size();
    std::vector<double> alternating = scan.weighted();
    for (std::size_t i = 1; i < n; i += 2) alternating[i] = -alternating[i];
    const std::vector<double> reversed = scan.problem().transform().forward(alternating);
    std::vector<double> gains(n);
    for (std::size_t k = 1; k < n; ++k) {
      const double cosine = scan.residual()[k] / scan.density()[k];
      const double sine = reversed[n - k];
      gains[k] = 0.5 * (cosine * cosine + sine * sine) * scan.density()[k];
    }
    return gains;
  }

  /// Where within half a cycle the line is strongest.
  static double refined(const std::vector<double>& weighted, double cycles) {
    const auto power = [&](double at) {
      return line_power(weighted, at / static_cast<double>(weighted.size()));
    };
    double centre = power(cycles);
    for (double step = 0.25; step > 0.01; step *= 0.5) {
      const double below = power(cycles - step);
      const double above = power(cycles + step);
      // The vertex of the parabola through three points.
      const double bend = below - 2.0 * centre + above;
      if (bend >= 0.0) continue;
      cycles += step * std::clamp(0.5 * (below - above) / bend, -1.0, 1.0);
      centre = power(cycles);
    }
    return cycles;
  }

  /// |sum x_i e^(-i turn)|^2, each factor turned from the one before; anew every so often, so that
  /// the rounding does not grow.
  static double line_power(const std::vector<double>& values, double cycles_per_value) {
    constexpr std::size_t kStretch = 4096;
    const double turn = 2.0 * std::numbers::pi * cycles_per_value;
    const double cosine = std::cos(turn);
    const double sine = std::sin(turn);
    double real = 0.0;
    double imaginary = 0.0;
    for (std::size_t first = 0; first < values.size(); first += kStretch) {
      double x = std::cos(turn * static_cast<double>(first));
      double y = std::sin(turn * static_cast<double>(first));
      for (std::size_t i = first; i < std::min(first + kStretch, values.size()); ++i) {
        real += values[i] * x;
        imaginary += values[i] * y;
        const double next = x * cosine - y * sine;
        y = x * sine + y * cosine;
        x = next;
      }
    }
    return real * real + imaginary * imaginary;
  }
};

}  // namespace

std::unique_ptr<Effect> make_periodic_disturbance() {
  return std::make_unique<PeriodicDisturbance>();
}

}  // namespace zerorate::diagnose
