#include "host_tools/lib/diagnose/effects/node_model_terms.hpp"

#include <cmath>

#include "host_tools/lib/identify/characterize.hpp"

namespace zerorate::diagnose {

double node_tick_s(const FitData& data) {
  const auto nanoseconds = [](double seconds) {
    return core::Duration::nanoseconds(std::llround(seconds * 1e9));
  };
  const core::Duration tick =
      identify::identification_tick(nanoseconds(data.span_s()), nanoseconds(data.period_s()));
  return static_cast<double>(tick.ns()) * 1e-9;
}

}  // namespace zerorate::diagnose
