#include "host_tools/lab/campaign/gain_summary.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace zerorate::campaign {
namespace {

constexpr double kGreatestErrorRatio = 1.01;
constexpr double kLeastCoverage = 0.93;
constexpr double kGreatestCoverage = 0.97;

}  // namespace

statistics::BootstrapFigure GainSummary::median(double Gain::*figure) const {
  return statistics::bootstrap(
      gains_.size(),
      [&](const std::vector<std::size_t>& drawn) {
        std::vector<double> values;
        values.reserve(drawn.size());
        for (const std::size_t i : drawn) values.push_back(gains_[i].*figure);
        std::ranges::sort(values);
        return values.empty() ? std::nan("") : statistics::quantile_of_sorted(values, 0.5);
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
bool GainSummary::scores_worse() const {
  return median(&Gain::log_score_gain_nats_per_sample).hi < 0.0;
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
  return "| hidden effect | recordings | in the model | log score gain, 10^-3 nats a sample | RSSE "
         "| heading drift | coverage before | after | the models |\n"
         "|---|---|---|---|---|---|---|---|---|\n";
}

std::string GainSummary::row() const {
  const auto score = median(&Gain::log_score_gain_nats_per_sample);
  const auto after = mean(&Gain::coverage95_extended);
  std::string misses;
  if (scores_worse()) misses += " log score";
  if (!errs_no_more()) misses += " error";
  if (!covers()) misses += " coverage";
  return fmt::format(
      "| {} | {} | {} | {:.3g} ({:.3g} to {:.3g}) | {:.4f} | {:.3f} | {:.3f} | {:.3f} ({:.3f} to "
      "{:.3f}) "
      "| {} |\n",
      effect_, size(), extensions_, 1e3 * score.value, 1e3 * score.lo, 1e3 * score.hi,
      median(&Gain::rsse_ratio).value, median(&Gain::heading_drift_ratio).value,
      mean(&Gain::coverage95_base).value, after.value, after.lo, after.hi,
      misses.empty() ? (scores_better() ? "pay" : "do no harm") : "harm:" + misses);
}

}  // namespace zerorate::campaign
