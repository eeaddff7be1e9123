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

constexpr std::size_t kMostToneStretches = 24;
constexpr std::size_t kFewestToneStretches = 8;
constexpr double kCyclesInAStretch = 20.0;
constexpr double kLeastTonePower = 10.0;  // over that of the noise, on average
constexpr double kOffShareOfMean = 0.25;  // of the mean power
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

struct Interval95 {
  double lo;
  double hi;
};

/// Wilson's interval of a share.
Interval95 share_interval(double share, double count) {
  constexpr double kZ = 1.959964;
  const double z2 = kZ * kZ / count;
  const double centre = (share + 0.5 * z2) / (1.0 + z2);
  const double half = kZ * std::sqrt((share * (1.0 - share) + 0.25 * z2) / count) / (1.0 + z2);
  return {std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

}  // namespace

std::optional<Intermittence> find_intermittence(const std::vector<double>& values, double period_s,
                                                const Tone& tone) {
  const double span_s = static_cast<double>(values.size()) * period_s;
  const auto stretches = static_cast<std::size_t>(
      std::min<double>(kMostToneStretches, span_s * tone.frequency_hz / kCyclesInAStretch));
  if (stretches < kFewestToneStretches) return std::nullopt;
  const std::size_t length = values.size() / stretches;
  // The phase is steady within a window.
  const double window_s = 2.0 * tone.coherence_time_s.value_or(span_s);
  const auto window =
      std::clamp(static_cast<std::size_t>(window_s / period_s), std::size_t{32}, length);
  const double turn = 2.0 * std::numbers::pi * tone.frequency_hz * period_s;
  std::vector<double> powers;
  double noise = 0.0;
  for (std::size_t s = 0; s < stretches; ++s) {
    const auto stretch = std::span(values).subspan(s * length, length);
    powers.push_back(power_in(stretch, window, turn));
    noise += power_beside(stretch, window, turn) / static_cast<double>(stretches);
  }
  for (double& power : powers) power -= noise;
  const auto count = static_cast<double>(stretches);
  const double mean = std::accumulate(powers.begin(), powers.end(), 0.0) / count;
  if (!(mean > kLeastTonePower * noise)) return std::nullopt;

  const auto is_off = [&](double power) { return power < kOffShareOfMean * mean; };
  const auto off = static_cast<double>(std::ranges::count_if(powers, is_off));
  // Stretches of a phase that wanders slowly are alike.
  const double independent = tone.coherence_time_s ? std::min(count, span_s / window_s) : count;
  const double by_chance = tone.coherence_time_s ? kOffOfAResonance : kOffOfASine;
  const double fewest = std::floor(off / count * independent);
  if (fewest < 1.0) return std::nullopt;
  const boost::math::binomial_distribution<> chance(std::floor(independent), by_chance);
  if (cdf(complement(chance, fewest - 1.0)) > kToneChance) return std::nullopt;

  const auto first = std::ranges::find_if_not(powers, is_off);
  const auto last = std::find_if_not(powers.rbegin(), powers.rend(), is_off);
  double on = 0.0;
  for (const double power : powers) on += is_off(power) ? 0.0 : power;
  const double share = 1.0 - off / count;
  const Interval95 interval = share_interval(share, count);
  const double stretch_s = static_cast<double>(length) * period_s;
  return Intermittence{
      .share = share,
      .share_lo = interval.lo,
      .share_hi = interval.hi,
      .amplitude_rad_s = 2.0 * std::sqrt(on / (count - off) / static_cast<double>(window)),
      .from_s = stretch_s * static_cast<double>(first - powers.begin()),
      .to_s = stretch_s * static_cast<double>(powers.rend() - last)};
}

}  // namespace zerorate::diagnose
