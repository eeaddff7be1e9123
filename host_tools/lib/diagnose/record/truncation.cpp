#include "host_tools/lib/diagnose/record/truncation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <vector>

#include "host_tools/lib/diagnose/record/cell_of_zero.hpp"
#include "host_tools/lib/identify/levels_near_zero.hpp"
#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::diagnose {
namespace {

using Counts = std::map<float, std::size_t>;

Counts counts_at_rest(const identify::RestSamples& samples, std::size_t axis) {
  identify::LevelsNearZero levels;
  for (const auto& rate : samples.rate_rad_s) levels.take(rate[axis]);
  return levels.counts();
}

/// Step of all values of an axis; nothing where they lie on no levels.
std::optional<double> step_of_axis(const Counts& at_rest, const Counts& on_the_move) {
  Counts all = at_rest;
  for (const auto& [value, count] : on_the_move) all[value] += count;
  // Where many are kept, few of them are far: the nearest ones tell the step.
  return step_of(all);
}

/// Width of the cell of zero by one axis, at rest or on the move, as rounded and as cut samples.
struct Witness {
  double step = 0.0;
  WidthOfZero rounded;
  WidthOfZero cut;
};

std::vector<Witness> witnesses_of(const identify::RestSamples& samples) {
  constexpr double kMiddleOfCut = 0.5;
  std::vector<Witness> witnesses;
  for (std::size_t axis = 0; axis < samples.axis_count; ++axis) {
    const Counts at_rest = counts_at_rest(samples, axis);
    const Counts& on_the_move = samples.levels_on_the_move[axis].counts();
    const auto step = step_of_axis(at_rest, on_the_move);
    if (!step) continue;
    for (const Counts& counts : {at_rest, on_the_move}) {
      if (counts.empty()) continue;
      const LevelsAboutZero levels = levels_about_zero(counts, *step);
      const auto rounded = width_of_zero(levels, 0.0);
      const auto cut = width_of_zero(levels, kMiddleOfCut);
      if (rounded && cut) witnesses.push_back({*step, *rounded, *cut});
    }
  }
  return witnesses;
}

/// Surprisal of several: twice the sum of those of n independent ones is chi squared of 2 n
/// (Fisher).
double surprisal_of(const std::vector<Witness>& witnesses) {
  double sum = 0.0;
  for (const auto& [step, rounded, cut] : witnesses) {
    sum -= statistics::log_student_tail(rounded.log_width / rounded.deviation, rounded.freedom);
  }
  return -statistics::log_chi_squared_tail(2.0 * sum, 2.0 * static_cast<double>(witnesses.size()));
}

/// The density between levels is known to so much, however many samples there are.
constexpr double kLeastDeviation = 0.05;

/// A figure by several, weighed by their deviations.
struct Weighed {
  double value = 0.0;
  double deviation = 0.0;
  double log_p_of_scatter = 0.0;  ///< probability that all scatter so about log 2
};
Weighed weigh(const std::vector<Witness>& witnesses) {
  double weights = 0.0;
  double sum = 0.0;
  double scatter = 0.0;
  for (const auto& [step, rounded, cut] : witnesses) {
    const double weight = 1.0 / (cut.deviation * cut.deviation + kLeastDeviation * kLeastDeviation);
    weights += weight;
    sum += weight * cut.log_width;
    scatter += weight * std::pow(cut.log_width - std::numbers::ln2, 2);
  }
  const auto freedom = static_cast<double>(witnesses.size());
  return {sum / weights, std::sqrt(1.0 / weights),
          statistics::log_chi_squared_tail(scatter, freedom)};
}

/// Share of the upper half in the cell of zero: a smooth density grows there as it does from the
/// level below to the level above, which lie three steps apart.
double upper_share(const LevelsAboutZero& levels) {
  const double up = std::cbrt(levels.count(1) + 0.5);
  const double down = std::cbrt(levels.count(-1) + 0.5);
  return up / (up + down);
}

}  // namespace

TruncationEvidence find_truncation(const identify::RestSamples& samples) {
  constexpr double kLeastLogP = -6.9;  // one in a thousand
  constexpr double kSameStep = 0.01;
  const std::vector<Witness> witnesses = witnesses_of(samples);
  if (witnesses.empty()) return {};
  TruncationEvidence evidence{
      .surprisal_nats = surprisal_of(witnesses), .is_examined = true, .axes = samples.axis_count};
  const double step = witnesses.front().step;
  const bool is_one_step = std::ranges::all_of(
      witnesses, [&](const Witness& one) { return std::abs(one.step - step) < kSameStep * step; });
  const Weighed width = weigh(witnesses);
  const double reach = statistics::kHalfWidth95 * width.deviation;
  const bool is_narrow = std::exp(width.value - reach) > 1.0;
  if (evidence.surprisal_nats > kTruncationThreshold_nats && is_one_step && is_narrow &&
      width.log_p_of_scatter > kLeastLogP) {
    evidence.found = Truncation{.step_rad_s = step,
                                .width = std::exp(width.value),
                                .width_lo = std::exp(width.value - reach),
                                .width_hi = std::exp(width.value + reach),
                                .surprisal_nats = evidence.surprisal_nats};
  }
  return evidence;
}

identify::RestSamples without_truncation(identify::RestSamples samples,
                                         const Truncation& truncation) {
  const double half = 0.5 * truncation.step_rad_s;
  for (std::size_t axis = 0; axis < samples.axis_count; ++axis) {
    const double up =
        upper_share(levels_about_zero(counts_at_rest(samples, axis), truncation.step_rad_s));
    const random::RandomStream stream{axis};
    for (std::size_t k = 0; k < samples.rate_rad_s.size(); ++k) {
      float& rate = samples.rate_rad_s[k][axis];
      const bool is_zero = std::abs(double{rate}) < half;
      const bool is_up = is_zero ? stream.uniform(static_cast<std::int64_t>(k)) < up : rate > 0.0F;
      rate = static_cast<float>((is_zero ? 0.0 : double{rate}) + (is_up ? half : -half));
    }
  }
  return samples;
}

}  // namespace zerorate::diagnose
