#include "host_tools/lib/campaign/gain_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace zerorate::campaign {
namespace {

constexpr double kGreatestErrorRatio = 1.01;
constexpr double kLeastCoverage = 0.93;
constexpr double kGreatestCoverage = 0.97;

double median_of(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

}  // namespace

statistics::BootstrapFigure GainSummary::median(double Gain::*figure) const {
  return statistics::bootstrap(
      gains_.size(),
      [&](const std::vector<std::size_t>& drawn) {
        std::vector<double> values;
        values.reserve(drawn.size());
        for (const std::size_t i : drawn) values.push_back(gains_[i].*figure);
        return values.empty() ? std::nan("") : median_of(std::move(values));
      },
      random::RandomStream(seed_));
}

statistics::BootstrapFigure GainSummary::mean(double Gain::*figure) const {
  return statistics::bootstrap(
      gains_.size(),
      [&](const std::vector<std::size_t>& drawn) {
        double sum = 0.0;
        for (const std::size_t i : drawn) sum += gains_[i].*figure;
        return sum / static_cast<double>(drawn.size());
      },
      random::RandomStream(seed_));
}

bool GainSummary::scores_better() const {
  return median(&Gain::log_score_gain_nats_per_sample).lo > 0.0;
}
bool GainSummary::errs_no_more() const {
  return median(&Gain::rsse_ratio).value <= kGreatestErrorRatio &&
         median(&Gain::heading_drift_ratio).value <= kGreatestErrorRatio;
}
bool GainSummary::covers() const {
  const double coverage = mean(&Gain::coverage95_extended).value;
  return coverage >= kLeastCoverage && coverage <= kGreatestCoverage;
}

std::string GainSummary::header() {
  return "| hidden effect | recordings | log score gain, 10^-3 nats a sample | RSSE | heading "
         "drift "
         "| coverage before | after | holds |\n|---|---|---|---|---|---|---|---|\n";
}

std::string GainSummary::row() const {
  const auto score = median(&Gain::log_score_gain_nats_per_sample);
  const auto after = mean(&Gain::coverage95_extended);
  std::string misses;
  if (!scores_better()) misses += " log score";
  if (!errs_no_more()) misses += " error";
  if (!covers()) misses += " coverage";
  return fmt::format(
      "| {} | {} | {:.3g} ({:.3g} to {:.3g}) | {:.4f} | {:.3f} | {:.3f} | {:.3f} ({:.3f} to "
      "{:.3f}) "
      "| {} |\n",
      effect_, size(), 1e3 * score.value, 1e3 * score.lo, 1e3 * score.hi,
      median(&Gain::rsse_ratio).value, median(&Gain::heading_drift_ratio).value,
      mean(&Gain::coverage95_base).value, after.value, after.lo, after.hi,
      misses.empty() ? "yes" : "not:" + misses);
}

}  // namespace zerorate::campaign
