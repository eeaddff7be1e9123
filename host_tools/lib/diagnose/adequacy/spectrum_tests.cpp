#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/special_functions/beta.hpp>
#include <cmath>
#include <utility>

#include "host_tools/lib/diagnose/adequacy/adequacy.hpp"
#include "host_tools/lib/diagnose/hypothesis/column_search.hpp"
#include "host_tools/lib/diagnose/hypothesis/linear_model.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

double frequency_hz(const FitData& data, double index) {
  return index / (2.0 * static_cast<double>(data.size()) * data.period_s());
}

/// c_k^2 / S_k summed over bands of a width given as a ratio.
void test_bands(const Hypothesis& hypothesis, double ratio, Tests& tests) {
  const std::vector<double>& c = hypothesis.residual();
  const std::vector<double>& density = hypothesis.density();
  const std::size_t n = c.size();
  for (std::size_t first = 1; first < n;) {
    const auto grown = static_cast<std::size_t>(static_cast<double>(first) * ratio);
    const std::size_t end = std::min(n, std::max(grown, first + 4));
    double sum = 0.0;
    for (std::size_t k = first; k < end; ++k) sum += c[k] * c[k] / density[k];
    const auto freedom = static_cast<double>(end - first);
    const FitData& data = hypothesis.data();
    tests.push_back({fmt::format("between {} and {} Hz the noise has {:.2f} times the "
                                 "expected power",
                                 units::in_figures(frequency_hz(data, static_cast<double>(first))),
                                 units::in_figures(frequency_hz(data, static_cast<double>(end))),
                                 sum / freedom),
                     statistics::log_chi_squared_tails(sum, freedom)});
    first = end;
  }
}

/// Two neighbouring coefficients hold nearly all of a steady line.
Test strongest_line(const Hypothesis& hypothesis, const std::vector<double>& sums) {
  double most = 0.0;
  std::size_t at = 1;
  for (std::size_t k = 1; k + 1 < sums.size(); ++k) {
    const double power = sums[k + 1] - sums[k - 1];
    if (power <= most) continue;
    most = power;
    at = k;
  }
  return {fmt::format(
              "a line stands out at {} Hz",
              units::in_figures(frequency_hz(hypothesis.data(), static_cast<double>(at) + 0.5), 4)),
          statistics::log_of_smallest(-0.5 * most, static_cast<double>(sums.size()))};
}

/// A line that wanders, or a resonance, fills more: windows of all widths, each against what lies
/// beside it, which is as wide again on both sides and at least 64 coefficients.
Test strongest_hump(const Hypothesis& hypothesis, const std::vector<double>& sums) {
  constexpr std::size_t kWidest = 2048;
  double least = 0.0;
  double widths = 0.0;
  double from = 0.0;
  double to = 0.0;
  double times = 1.0;
  for (std::size_t width = 8; width <= kWidest && 16 * width <= sums.size(); width *= 2) {
    const std::size_t beside = std::max<std::size_t>(2 * width, 64);
    const std::size_t step = width / 4;
    double most = 0.0;
    std::size_t at = 0;
    for (std::size_t k = beside; k + width + beside < sums.size(); k += step) {
      const double inside = sums[k + width] - sums[k];
      const double around = sums[k] - sums[k - beside] + sums[k + width + beside] - sums[k + width];
      if (inside <= most * around) continue;
      most = inside / around;
      at = k;
    }
    const double share = most / (1.0 + most);
    const double p =
        boost::math::ibetac(0.5 * static_cast<double>(width), static_cast<double>(beside), share);
    const std::size_t places = sums.size() / step;
    const double log_p =
        statistics::log_of_smallest(std::log(std::max(p, 1e-290)), static_cast<double>(places));
    widths += 1.0;
    if (log_p >= least) continue;
    least = log_p;
    from = frequency_hz(hypothesis.data(), static_cast<double>(at + 1));
    to = frequency_hz(hypothesis.data(), static_cast<double>(at + width));
    times = most * 2.0 * static_cast<double>(beside) / static_cast<double>(width);
  }
  return {fmt::format("a line stands out between {} and {} Hz, with {:.3g} times the power "
                      "beside it",
                      units::in_figures(from, 4), units::in_figures(to, 4), times),
          statistics::log_of_smallest(least, widths)};
}

/// Not a line whose phase wanders, which has no columns.
bool is_steady_tone(const Part& part) {
  return part.effect == "periodic_disturbance" && !part.columns.empty();
}

/// Harmonics: a tone of another shape than a sine has power at whole multiples of its frequency.
void test_harmonics(const Hypothesis& hypothesis, Tests& tests) {
  constexpr double kHighest = 6.0;
  constexpr double kNyquist = 0.49;  // cycles a sample
  const FitData& data = hypothesis.data();
  const ColumnSearch scan(hypothesis);
  for (const Part& part : hypothesis.parts()) {
    if (!is_steady_tone(part)) continue;
    const double cycles = part.shape.front() * data.period_s();
    double gain = 0.0;
    double freedom = 0.0;
    for (double harmonic = 2.0; harmonic <= kHighest; harmonic += 1.0) {
      if (harmonic * cycles > kNyquist) break;
      auto [cosine, sine] = tone_columns(data, harmonic * cycles);
      const std::array<Column, 2> columns{std::move(cosine), std::move(sine)};
      gain += scan.gain(columns);
      freedom += 2.0;
    }
    if (freedom == 0.0) continue;
    tests.push_back({fmt::format("the tone at {} Hz has harmonics: it is no sine",
                                 units::in_figures(part.shape.front(), 4)),
                     statistics::log_chi_squared_tail(2.0 * gain, freedom)});
  }
}

/// A tone whose strength or phase drifts over the record: it times the first two Legendre
/// polynomials of time.
void test_steadiness(const Hypothesis& hypothesis, Tests& tests) {
  const FitData& data = hypothesis.data();
  const ColumnSearch scan(hypothesis);
  for (const Part& part : hypothesis.parts()) {
    if (!is_steady_tone(part)) continue;
    const double rad_per_s = 2.0 * std::numbers::pi * part.shape.front();
    std::vector<Column> columns;
    for (const double phase : {0.0, 0.5 * std::numbers::pi}) {
      for (const bool is_second : {false, true}) {
        columns.push_back(fast_column_of(data, [&](double t) {
          const double x = 2.0 * t / data.span_s() - 1.0;
          return (is_second ? 1.5 * x * x - 0.5 : x) * std::cos(rad_per_s * t - phase);
        }));
      }
    }
    tests.push_back({fmt::format("the tone at {} Hz changes over the record",
                                 units::in_figures(part.shape.front(), 4)),
                     statistics::log_chi_squared_tail(2.0 * scan.gain(columns),
                                                      static_cast<double>(columns.size()))});
  }
}

/// Events that come like a clock are no telegraph and no relaxation, but something periodic.
void test_event_times(const Hypothesis& hypothesis, Tests& tests) {
  for (const Part& part : hypothesis.parts()) {
    if (part.log_p_of_even_times == 0.0) continue;
    const std::string_view events = part.effect == "random_telegraph_noise" ? "switches" : "jumps";
    tests.push_back({fmt::format("the bias {} at even intervals, not at random", events),
                     part.log_p_of_even_times});
  }
}

}  // namespace

Tests test_spectrum(const StandardisedResidual& residual) {
  Tests tests;
  for (const double ratio : {2.0, 1.3}) test_bands(*residual.hypothesis, ratio, tests);
  const std::vector<double>& c = residual.hypothesis->residual();
  const std::vector<double>& density = residual.hypothesis->density();
  std::vector<double> sums(c.size());
  for (std::size_t k = 1; k < c.size(); ++k) sums[k] = sums[k - 1] + c[k] * c[k] / density[k];
  tests.push_back(strongest_line(*residual.hypothesis, sums));
  tests.push_back(strongest_hump(*residual.hypothesis, sums));
  test_harmonics(*residual.hypothesis, tests);
  test_steadiness(*residual.hypothesis, tests);
  test_event_times(*residual.hypothesis, tests);
  return tests;
}

}  // namespace zerorate::diagnose
