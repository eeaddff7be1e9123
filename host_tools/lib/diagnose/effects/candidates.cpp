#include "host_tools/lib/diagnose/effects/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "host_tools/lib/identify/characterize.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::diagnose {

Candidate candidate_with(const Hypothesis& without, Part part) {
  const Hypothesis with = without.with(part);
  return {.part = std::move(part),
          .gain_nats = with.log_likelihood() - without.log_likelihood(),
          .noise = with.noise().spectrum};
}

Candidate placed_candidate(const Hypothesis& without, Part part) {
  Candidate candidate = candidate_with(without, std::move(part));
  candidate.part.starts = {candidate.noise};
  return candidate;
}

namespace {

constexpr std::size_t kDrawnPoints = 1500;

}  // namespace

std::optional<Candidate> mean_candidate(const Hypothesis& without, const MeanSearch& search) {
  std::optional<MeanFit> fit = fit_mean(without, search);
  if (!fit) return std::nullopt;
  return Candidate{.part = std::move(fit->part), .gain_nats = fit->gain_nats};
}

std::optional<Candidate> timed_mean_candidate(const Hypothesis& without, const MeanSearch& search,
                                              double shortest, double longest) {
  constexpr double kCrossingsPerEFold = 0.3;
  std::optional<Candidate> candidate = mean_candidate(without, search);
  if (candidate) {
    candidate->surprisal_nats = statistics::surprisal_of_search(
        candidate->gain_nats, 1.0, kCrossingsPerEFold * std::log(longest / shortest));
  }
  return candidate;
}

double shape_error(const FittedPart& fitted, const Column& derivative) {
  const double information = ColumnSearch(fitted.hypothesis).information(derivative);
  return 1.0 / std::sqrt(std::max(information, 1e-300));
}

Drawing drawing_of(const FittedPart& fitted) {
  const FitData& data = fitted.hypothesis.data();
  std::vector<double> coefficients(data.size());
  for (std::size_t i = 0; i < fitted.part().columns.size(); ++i) {
    const Column& column = fitted.part().columns[i];
    for (std::size_t k = column.first; k < column.end(); ++k) {
      coefficients[k] += fitted.amplitude(i) * column.coefficients[k - column.first];
    }
  }
  const std::vector<double> mean = data.transform().inverse(coefficients);
  const std::vector<double>& rate = data.rate_rad_s();
  const double level = data.median_rad_s() + std::accumulate(rate.begin(), rate.end(), 0.0) /
                                                 static_cast<double>(rate.size());
  Drawing drawing{.effect = std::string(fitted.part().effect)};
  const std::size_t step = std::max<std::size_t>(1, mean.size() / kDrawnPoints);
  for (std::size_t k = 0; k < mean.size(); k += step) {
    drawing.curve.push_back({data.series().time_s(k), level + mean[k]});
  }
  return drawing;
}

using statistics::kHalfWidth95;

Parameter positive_parameter(std::string name, double value, double log_error) {
  const double factor = std::exp(kHalfWidth95 * log_error);
  return {std::move(name), value, value / factor, value * factor};
}

Parameter parameter(std::string name, double value, double standard_error) {
  const double reach = kHalfWidth95 * standard_error;
  return {std::move(name), value, value - reach, value + reach};
}

double node_tick_s(const FitData& data) {
  const auto nanoseconds = [](double seconds) {
    return core::Duration::nanoseconds(std::llround(seconds * 1e9));
  };
  const core::Duration tick =
      identify::identification_tick(nanoseconds(data.span_s()), nanoseconds(data.period_s()));
  return static_cast<double>(tick.ns()) * 1e-9;
}

}  // namespace zerorate::diagnose
