#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "host_tools/lib/diagnose/effects/candidates.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/diagnose/effects/intermittence.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;

constexpr double kFewestCycles = 1.5;

/// "37.67 Hz"; below 1 Hz with its period: "0.0187 Hz, a period of 53.5 s".
std::string frequency_in_words(double frequency_hz, int digits) {
  std::string words = units::in_figures(frequency_hz, digits) + " Hz";
  if (frequency_hz < 1.0) words += ", a period of " + units::in_figures(1.0 / frequency_hz) + " s";
  return words;
}

/// A line in the spectrum: either a sine of constant frequency, amplitude and phase, with columns
/// cosine and sine and its frequency in Hz as the part's shape; or one whose phase wanders, a
/// resonance, with a term of the noise.
class PeriodicDisturbance final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "periodic_disturbance"; }
  [[nodiscard]] Pace pace() const override { return Pace::either; }

  [[nodiscard]] Description describe(const FittedPart& fitted) const override {
    const bool wanders = fitted.part().terms.line;
    Description description = wanders ? describe_wandering(fitted) : describe_sine(fitted);
    const FitData& data = fitted.hypothesis.data();
    const auto intermittence =
        find_intermittence(fitted.hypothesis.repaired_values(), data.period_s(), tone_of(fitted));
    if (intermittence) add_intermittence(*intermittence, data.series().time_s(0), description);
    return description;
  }

  void add_to_model(const FittedPart& fitted, model::SensorModel& model) const override {
    if (fitted.part().terms.line) {
      add_wandering(fitted, model);
    } else {
      const double amplitude = std::hypot(fitted.amplitude(0), fitted.amplitude(1));
      model.harmonic.push_back({.rms_rad_s = amplitude / std::numbers::sqrt2,
                                .frequency_hz = fitted.part().shape.front(),
                                .coherence_time_s = fitted.hypothesis.data().span_s()});
    }
  }

 private:
  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without) const override {
    std::optional<Candidate> sine = examine_sine(without);
    std::optional<Candidate> wandering = examine_wandering(without);
    if (!wandering) return sine;
    return sine && sine->surprisal_nats >= wandering->surprisal_nats ? sine : wandering;
  }

  /// The price of a gain for which all frequencies were searched.
  static double surprisal_of_line(const Hypothesis& without, double gain, double amplitudes) {
    const double bins = 0.5 * static_cast<double>(without.data().size());
    return statistics::surprisal_of_search(
        gain, amplitudes, bins * std::sqrt(std::numbers::pi * std::max(gain, 1.0) / 3.0));
  }

  [[nodiscard]] std::optional<Candidate> examine_sine(const Hypothesis& without) const {
    std::optional<Candidate> candidate =
        mean_candidate(without, [this](const ColumnSearch& scan) { return search(scan); });
    if (candidate) {
      candidate->surprisal_nats = surprisal_of_line(without, candidate->gain_nats, 2.0);
      candidate->time_scale_s = 1.0 / candidate->part.shape.front();
    }
    return candidate;
  }

  /// The widths that are tried share their power with neighbours, and so the price of one of them.
  [[nodiscard]] std::optional<Candidate> examine_wandering(const Hypothesis& without) const {
    if (without.terms().line) return std::nullopt;
    const std::optional<Run> window = strongest_window(without);
    if (!window) return std::nullopt;
    Candidate candidate = placed_candidate(
        without,
        {.effect = name(), .terms = {.line = true}, .starts = {start_in(without, *window)}});
    candidate.surprisal_nats = surprisal_of_line(without, candidate.gain_nats, 1.0);
    candidate.time_scale_s = 1.0 / frequency_hz(without.data(), candidate.noise.line_angle);
    return candidate;
  }

  /// Coefficients with more power than expected: by the likelihood of one factor for all of them.
  static std::optional<Run> strongest_window(const Hypothesis& without) {
    constexpr std::size_t kNarrowest = 8;
    constexpr std::size_t kLowest = 128;  // half cycles, for 40 lost phases (fit_spectrum)
    const std::vector<double>& c = without.residual();
    const std::vector<double>& density = without.density();
    std::vector<double> sums(c.size() + 1);
    for (std::size_t k = 1; k < c.size(); ++k) {
      sums[k + 1] = sums[k] + c[k] * c[k] / density[k];
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

  /// The likeliest of three widths.
  static NoiseSpectrum start_in(const Hypothesis& without, const Run& window) {
    const auto size = static_cast<double>(without.data().size());
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
    const std::size_t centre = (window.first + window.end) / 2;
    return likeliest_of(starts, bin_coefficients(without.residual(), centre),
                        without.data().size());
  }

  static Tone tone_of(const FittedPart& fitted) {
    if (!fitted.part().terms.line) return {.frequency_hz = fitted.part().shape.front()};
    const FitData& data = fitted.hypothesis.data();
    const NoiseSpectrum& noise = fitted.hypothesis.noise().spectrum;
    return {.frequency_hz = frequency_hz(data, noise.line_angle),
            .coherence_time_s = noise.line_samples * data.period_s()};
  }

  static void add_intermittence(const Intermittence& found, double start_s,
                                Description& description) {
    const double amplitude = found.amplitude_rad_s * kDegPerRad;
    description.parameters.push_back({"time_share", found.share, found.share_lo, found.share_hi});
    description.sentence += fmt::format(
        " It is intermittent: of {:.2g} deg/s, in {:.0f} % of the time [{:.0f}, {:.0f}], between "
        "{:.0f} and {:.0f} s. A model has it at all times.",
        amplitude, 100.0 * found.share, 100.0 * found.share_lo, 100.0 * found.share_hi,
        start_s + found.from_s, start_s + found.to_s);
  }

  static double frequency_hz(const FitData& data, double angle) {
    return angle / (2.0 * std::numbers::pi * data.period_s());
  }

  [[nodiscard]] static Description describe_wandering(const FittedPart& fitted) {
    const FitData& data = fitted.hypothesis.data();
    const NoiseSpectrum& noise = fitted.hypothesis.noise().spectrum;
    const SpectrumFit& fit = fitted.hypothesis.noise();
    // The logit of angle / pi is what is fitted.
    const double angle_error = fit.error(NoiseParameterId::line_angle) * noise.line_angle *
                               (1.0 - noise.line_angle / std::numbers::pi);
    const double amplitude = std::sqrt(2.0 * noise.line_variance) * kDegPerRad;
    const double frequency = frequency_hz(data, noise.line_angle);
    const double coherence = noise.line_samples * data.period_s();
    return {.parameters = {positive_parameter("amplitude_dps", amplitude,
                                              0.5 * fit.error(NoiseParameterId::line_variance)),
                           parameter("frequency_hz", frequency, frequency_hz(data, angle_error)),
                           positive_parameter("coherence_time_s", coherence,
                                              fit.error(NoiseParameterId::line_samples))},
            .sentence = fmt::format("An oscillation of {:.2g} deg/s about {} (or an alias of "
                                    "it), whose phase wanders within {} s, is in the rate: "
                                    "vibration, a resonance, a beat.",
                                    amplitude, frequency_in_words(frequency, 4),
                                    units::in_figures(coherence, 2))};
  }

  /// White noise, to a node whose ticks are longer than the coherence.
  static void add_wandering(const FittedPart& fitted, model::SensorModel& model) {
    const FitData& data = fitted.hypothesis.data();
    const NoiseSpectrum& noise = fitted.hypothesis.noise().spectrum;
    const double tick_s = node_tick_s(data);
    const double coherence_s = noise.line_samples * data.period_s();
    if (coherence_s > tick_s) {
      model.harmonic.push_back({.rms_rad_s = std::sqrt(noise.line_variance),
                                .frequency_hz = frequency_hz(data, noise.line_angle),
                                .coherence_time_s = coherence_s});
      return;
    }
    const double highest = std::numbers::pi * data.period_s() / tick_s;
    const double white = model.white.angle_random_walk_rad_per_sqrt_s;
    const double added = noise.line_density(0.0, 2.0 * highest) * data.period_s();
    model.white.angle_random_walk_rad_per_sqrt_s = std::sqrt(white * white + added);
  }

  [[nodiscard]] static Description describe_sine(const FittedPart& fitted) {
    const double a = fitted.amplitude(0);
    const double b = fitted.amplitude(1);
    const double amplitude = std::hypot(a, b) * kDegPerRad;
    const double error =
        std::hypot(a * fitted.amplitude_error(0), b * fitted.amplitude_error(1)) / std::hypot(a, b);
    const double frequency = fitted.part().shape.front();
    const double rad_per_s = 2.0 * std::numbers::pi * frequency;
    const Column derivative = fast_column_of(fitted.hypothesis.data(), [&](double time_s) {
      const double turn = rad_per_s * time_s;
      return 2.0 * std::numbers::pi * time_s * (b * std::cos(turn) - a * std::sin(turn));
    });
    return {.parameters = {parameter("amplitude_dps", amplitude, error * kDegPerRad),
                           parameter("frequency_hz", frequency, shape_error(fitted, derivative))},
            .sentence = fmt::format("A sine of {:.2g} deg/s at {} (or an alias of it) is in "
                                    "the rate: vibration, a supply, a beat.",
                                    amplitude, frequency_in_words(frequency, 5)),
            .drawing = drawing_of(fitted)};
  }

  [[nodiscard]] std::optional<Part> search(const ColumnSearch& scan) const {
    const FitData& data = scan.data();
    const std::vector<double> gains = line_gains(scan);
    const auto first = static_cast<std::ptrdiff_t>(2.0 * kFewestCycles);
    const auto best = std::max_element(gains.begin() + first, gains.end() - 1) - gains.begin();
    // Without any noise, as where almost all values are equal, no line has a finite gain.
    if (!std::isfinite(*(gains.begin() + best))) return std::nullopt;
    const double cycles =
        refined(scan.precision_weighted_residual(), 0.5 * static_cast<double>(best)) /
        static_cast<double>(data.size());
    auto [cosine, sine] = tone_columns(data, cycles);
    return Part{.effect = name(),
                .columns = {std::move(cosine), std::move(sine)},
                .shape = {cycles / data.period_s()}};
  }

  /// Gains of a line at k / 2n cycles a sample, for every k.
  static std::vector<double> line_gains(const ColumnSearch& scan) {
    // The cosine transform of (-1)^i x_i, read backwards, is the sine transform of x.
    const std::size_t n = scan.data().size();
    std::vector<double> alternating = scan.precision_weighted_residual();
    for (std::size_t i = 1; i < n; i += 2) alternating[i] = -alternating[i];
    const std::vector<double> reversed = scan.data().transform().forward(alternating);
    const std::vector<double>& precision = scan.precision();
    std::vector<double> gains(n);
    for (std::size_t k = 1; k < n; ++k) {
      const double cosine = scan.residual()[k] * precision[k];
      const double sine = reversed[n - k];
      gains[k] = 0.5 * (cosine * cosine + sine * sine) / precision[k];
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
      if (!(bend < 0.0)) continue;
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
