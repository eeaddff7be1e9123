#include "host_tools/lib/diagnose/effects/intermittence.hpp"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <span>

namespace zerorate::diagnose {
namespace {

using Share = boost::math::binomial_distribution<>;

constexpr std::size_t kMostToneStretches = 24;
constexpr std::size_t kFewestToneStretches = 8;
constexpr double kCyclesInAStretch = 20.0;
constexpr double kLeastTonePower = 10.0;  // mean power over that of the noise
constexpr double kOffShareOfMean = 0.25;  // share of the mean power
constexpr double kOffOfASine = 0.05;
constexpr double kOffOfAResonance = 0.22;
constexpr double kToneChance = 1e-3;

/// |sum x e^(-i turn)|^2 over the number of values: the power of white noise is its variance.
double power_at(std::span<const double> values, double turn_per_value) {
  const std::complex<double> step = std::polar(1.0, -turn_per_value);
  std::complex<double> factor{1.0, 0.0};
  std::complex<double> sum{};
  for (const double value : values) {
    sum += value * factor;
    factor *= step;
  }
  return std::norm(sum) / static_cast<double>(values.size());
}

/// Mean power at a frequency in windows of a stretch.
double power_in(std::span<const double> stretch, std::size_t window, double turn_per_value) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t first = 0; first + window <= stretch.size(); first += window, ++count) {
    sum += power_at(stretch.subspan(first, window), turn_per_value);
  }
  return sum / static_cast<double>(count);
}

/// Mean power at frequencies beside a tone, beyond the side lobes of a window.
double power_beside(std::span<const double> stretch, std::size_t window, double turn_per_value) {
  const double lobe = 2.0 * std::numbers::pi / static_cast<double>(window);
  double sum = 0.0;
  int count = 0;
  for (const double lobes : {-9.5, -7.5, -5.5, 5.5, 7.5, 9.5}) {
    const double turn = turn_per_value + lobes * lobe;
    if (turn <= 0.0 || turn >= std::numbers::pi) continue;
    sum += power_in(stretch, window, turn);
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

/// Power of a tone in stretches of equal length, without that of the noise around it.
struct StretchPowers {
  std::size_t length = 0;  ///< values in a stretch
  std::size_t window = 0;  ///< values within which the phase is steady
  std::vector<double> powers;
  double noise = 0.0;

  [[nodiscard]] double mean() const {
    return std::accumulate(powers.begin(), powers.end(), 0.0) / static_cast<double>(powers.size());
  }
};

StretchPowers measure(const std::vector<double>& values, double period_s, const Tone& tone,
                      std::size_t stretches) {
  constexpr std::size_t kShortestWindow = 32;
  StretchPowers measured{.length = values.size() / stretches};
  const double window_s = 2.0 * tone.coherence_time_s.value_or(HUGE_VAL);
  const double length = static_cast<double>(measured.length);
  measured.window =
      std::max(kShortestWindow, static_cast<std::size_t>(std::min(length, window_s / period_s)));
  if (measured.window > measured.length) return measured;
  const double turn = 2.0 * std::numbers::pi * tone.frequency_hz * period_s;
  for (std::size_t s = 0; s < stretches; ++s) {
    const auto stretch = std::span(values).subspan(s * measured.length, measured.length);
    measured.powers.push_back(power_in(stretch, measured.window, turn));
    measured.noise += power_beside(stretch, measured.window, turn) / static_cast<double>(stretches);
  }
  for (double& power : measured.powers) power -= measured.noise;
  return measured;
}

/// Whether so many of all stretches without a tone that is there at all times are no surprise.
/// Stretches of a phase that wanders slowly are alike, and count as fewer.
bool is_chance(double off, double stretches, double span_s, const Tone& tone) {
  const double independent = tone.coherence_time_s
                                 ? std::min(stretches, 0.5 * span_s / *tone.coherence_time_s)
                                 : stretches;
  const double fewest = std::floor(off / stretches * independent);
  if (fewest < 1.0) return true;
  const Share chance(std::floor(independent),
                     tone.coherence_time_s ? kOffOfAResonance : kOffOfASine);
  return cdf(complement(chance, fewest - 1.0)) > kToneChance;
}

}  // namespace

std::optional<Intermittence> find_intermittence(const std::vector<double>& values, double period_s,
                                                const Tone& tone) {
  const double span_s = static_cast<double>(values.size()) * period_s;
  const auto stretches = static_cast<std::size_t>(
      std::min<double>(kMostToneStretches, span_s * tone.frequency_hz / kCyclesInAStretch));
  if (stretches < kFewestToneStretches) return std::nullopt;
  const StretchPowers measured = measure(values, period_s, tone, stretches);
  const std::vector<double>& powers = measured.powers;
  if (powers.empty() || !(measured.mean() > kLeastTonePower * measured.noise)) return std::nullopt;

  const double least = kOffShareOfMean * measured.mean();
  const auto is_on = [&](double power) { return power >= least; };
  const auto count = static_cast<double>(stretches);
  const auto on = static_cast<double>(std::ranges::count_if(powers, is_on));
  if (is_chance(count - on, count, span_s, tone)) return std::nullopt;

  constexpr double kTail = 0.025;
  const auto first = std::ranges::find_if(powers, is_on);
  const auto last = std::find_if(powers.rbegin(), powers.rend(), is_on);
  double sum = 0.0;
  for (const double power : powers) sum += is_on(power) ? power : 0.0;
  const double stretch_s = static_cast<double>(measured.length) * period_s;
  return Intermittence{
      .share = on / count,
      .share_lo = Share::find_lower_bound_on_p(count, on, kTail),
      .share_hi = Share::find_upper_bound_on_p(count, on, kTail),
      .amplitude_rad_s = 2.0 * std::sqrt(sum / on / static_cast<double>(measured.window)),
      .from_s = stretch_s * static_cast<double>(first - powers.begin()),
      .to_s = stretch_s * static_cast<double>(powers.rend() - last)};
}

}  // namespace zerorate::diagnose
