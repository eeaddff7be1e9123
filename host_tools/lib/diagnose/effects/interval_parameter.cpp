#include "host_tools/lib/diagnose/effects/interval_parameter.hpp"

#include <cmath>
#include <utility>

#include "host_tools/lib/statistics/normal.hpp"

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

}  // namespace zerorate::diagnose
