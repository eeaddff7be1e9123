#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/diagnose/effects/mean_effect.hpp"
#include "host_tools/lib/diagnose/effects/spectral.hpp"
#include "host_tools/lib/statistics/search_significance.hpp"

namespace zerorate::diagnose {
namespace {

constexpr double kFewestCycles = 1.5;

/// A line in the spectrum: either a sine of constant frequency, amplitude and phase, with columns
/// cosine and sine and its frequency in Hz as the part's shape; or one whose phase wanders, a
/// resonance, with a term of the noise.
class PeriodicDisturbance final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "periodic_disturbance"; }

  [[nodiscard]] std::optional<Offer> examine(const Explanation& without) const override {
    std::optional<Offer> sine = examine_sine(without);
    std::optional<Offer> wandering = examine_wandering(without);
    if (!wandering) return sine;
    return sine && sine->surprise_nats >= wandering->surprise_nats ? sine : wandering;
  }

  [[nodiscard]] Account tell(const Found& found) const override {
    return found.part().terms.line ? tell_wandering(found) : tell_sine(found);
  }

  void extend(const Found& found, model::SensorModel& model) const override {
    if (found.part().terms.line) {
      extend_by_wandering(found, model);
    } else {
      const double amplitude = std::hypot(found.amplitude(0), found.amplitude(1));
      model.harmonic.push_back({.rms_rad_s = amplitude / std::numbers::sqrt2,
                                .frequency_hz = found.part().shape.front(),
                                .coherence_time_s = found.all.problem().span_s()});
    }
  }

 private:
  /// The price of a gain for which all frequencies were searched.
  static double surprise_of_line(const Explanation& without, double gain, double amplitudes) {
    const double bins = 0.5 * static_cast<double>(without.problem().size());
    return statistics::surprise_of_search(
        gain, amplitudes, bins * std::sqrt(std::numbers::pi * std::max(gain, 1.0) / 3.0));
  }

  [[nodiscard]] std::optional<Offer> examine_sine(const Explanation& without) const {
    std::optional<Offer> offer =
        offer_of_mean(without, [this](const MeanScan& scan) { return search(scan); });
    if (offer) offer->surprise_nats = surprise_of_line(without, offer->gain_nats, 2.0);
    return offer;
  }

  /// The widths that are tried share their power with neighbours, and so the price of one of them.
  [[nodiscard]] std::optional<Offer> examine_wandering(const Explanation& without) const {
    if (without.terms().line) return std::nullopt;
    const std::optional<Run> window = strongest_window(without);
    if (!window) return std::nullopt;
    Offer offer = placed_offer_with(
        without,
        {.effect = name(), .terms = {.line = true}, .starts = starts_in(without, *window)});
    offer.surprise_nats = surprise_of_line(without, offer.gain_nats, 1.0);
    return offer;
  }

  /// Coefficients with more power than expected: by the likelihood of one factor for all of them.
  static std::optional<Run> strongest_window(const Explanation& without) {
    constexpr std::size_t kNarrowest = 8;
    constexpr std::size_t kLowest = 128;  // so many half cycles, for 40 lost phases (fit_spectrum)
    const std::vector<double>& c = without.residual();
    std::vector<double> sums(c.size() + 1);
    for (std::size_t k = 1; k < c.size(); ++k) {
      sums[k + 1] = sums[k] + c[k] * c[k] / without.density()[k];
    }
    std::optional<Run> strongest;
    double most = 0.0;
    for (std::size_t width = kNarrowest; 4 * width <= c.size(); width *= 2) {
      const auto count = static_cast<double>(width);
      for (std::size_t first = std::max(2 * width, kLowest); first + width <= c.size();
           first += width / 4) {
        const double ratio = (sums[first + width] - sums[first]) / count;
        if (ratio <= 1.0) continue;
        const double gain = 0.5 * count * (ratio - 1.0 - std::log(ratio));
        if (gain <= most) continue;
        most = gain;
        strongest = Run{first, first + width};
      }
    }
    return strongest;
  }

  static std::vector<NoiseSpectrum> starts_in(const Explanation& without, const Run& window) {
    const auto size = static_cast<double>(without.problem().size());
    const auto width = static_cast<double>(window.end - window.first);
    double excess = 0.0;
    for (std::size_t k = window.first; k < window.end; ++k) {
      excess += without.residual()[k] * without.residual()[k] - without.density()[k];
    }
    std::vector<NoiseSpectrum> starts;
    for (const double broader : {1.0, 0.3, 3.0}) {
      NoiseSpectrum start = without.noise().spectrum;
      start.line_variance = std::max(excess, 0.0) / size;
      start.line_angle =
          std::numbers::pi * (static_cast<double>(window.first) + 0.5 * width) / size;
      start.line_samples = 4.0 * size / (std::numbers::pi * width * broader);
      starts.push_back(start);
    }
    return starts;
  }

  static double frequency_hz(const Problem& problem, double angle) {
    return angle / (2.0 * std::numbers::pi * problem.period_s());
  }

  [[nodiscard]] static Account tell_wandering(const Found& found) {
    const Problem& problem = found.all.problem();
    const NoiseSpectrum& noise = found.all.noise().spectrum;
    const NoiseErrors& errors = found.all.noise().errors;
    const double amplitude = std::sqrt(2.0 * noise.line_variance) * kDegPerRad;
    const double frequency = frequency_hz(problem, noise.line_angle);
    const double coherence = noise.line_samples * problem.period_s();
    return {
        .parameters = {positive_parameter("amplitude_dps", amplitude,
                                          0.5 * errors.log_line_variance),
                       parameter("frequency_hz", frequency,
                                 frequency_hz(problem, errors.line_angle)),
                       positive_parameter("coherence_time_s", coherence, errors.log_line_samples)},
        .sentence = fmt::format("An oscillation of {:.2g} deg/s about {:.4g} Hz (or an alias of "
                                "it), whose phase wanders within {:.2g} s, is in the rate: "
                                "vibration, a resonance, a beat.",
                                amplitude, frequency, coherence)};
  }

  /// To a node whose ticks are longer than the coherence it is white noise.
  static void extend_by_wandering(const Found& found, model::SensorModel& model) {
    const Problem& problem = found.all.problem();
    const NoiseSpectrum& noise = found.all.noise().spectrum;
    const double tick_s = node_tick_s(problem);
    const double coherence_s = noise.line_samples * problem.period_s();
    if (coherence_s > tick_s) {
      model.harmonic.push_back({.rms_rad_s = std::sqrt(noise.line_variance),
                                .frequency_hz = frequency_hz(problem, noise.line_angle),
                                .coherence_time_s = coherence_s});
      return;
    }
    const double highest = std::numbers::pi * problem.period_s() / tick_s;
    const double white = model.white.angle_random_walk_rad_per_sqrt_s;
    const double added = noise.line_density(0.0, 2.0 * highest) * problem.period_s();
    model.white.angle_random_walk_rad_per_sqrt_s = std::sqrt(white * white + added);
  }

  [[nodiscard]] static Account tell_sine(const Found& found) {
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
