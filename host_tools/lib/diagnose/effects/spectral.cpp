#include "host_tools/lib/diagnose/effects/spectral.hpp"

#include <cmath>
#include <vector>

#include "host_tools/lib/identify/characterize.hpp"

namespace zerorate::diagnose {

namespace {

Explanation joined(const Explanation& without, const Part& part) {
  std::vector<Part> parts = without.parts();
  parts.push_back(part);
  return {without.problem(), std::move(parts), &without};
}

}  // namespace

Offer offer_with(const Explanation& without, Part part) {
  const Explanation with = joined(without, part);
  return {std::move(part), with.log_likelihood() - without.log_likelihood(), 0.0};
}

Offer placed_offer_with(const Explanation& without, Part part) {
  const Explanation with = joined(without, part);
  part.starts = {with.noise().spectrum};
  return {std::move(part), with.log_likelihood() - without.log_likelihood(), 0.0};
}

Parameter positive_parameter(std::string name, double value, double log_error) {
  const double factor = std::exp(1.96 * log_error);
  return {std::move(name), value, value / factor, value * factor};
}

Parameter parameter(std::string name, double value, double standard_error) {
  return {std::move(name), value, value - 1.96 * standard_error, value + 1.96 * standard_error};
}

double node_tick_s(const Problem& problem) {
  const auto nanoseconds = [](double seconds) {
    return core::Duration::nanoseconds(std::llround(seconds * 1e9));
  };
  const core::Duration tick =
      identify::identification_tick(nanoseconds(problem.span_s()), nanoseconds(problem.period_s()));
  return static_cast<double>(tick.ns()) * 1e-9;
}

}  // namespace zerorate::diagnose
