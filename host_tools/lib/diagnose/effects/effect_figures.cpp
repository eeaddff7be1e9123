#include "host_tools/lib/diagnose/effects/effect_figures.hpp"

#include <cmath>
#include <utility>

#include "host_tools/lib/identify/characterize.hpp"
#include "host_tools/lib/statistics/tails.hpp"

namespace zerorate::diagnose {

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
