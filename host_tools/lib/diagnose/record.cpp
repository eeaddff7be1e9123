#include "host_tools/lib/diagnose/record.hpp"

#include <algorithm>
#include <cmath>

namespace zerorate::diagnose {
namespace {

/// Holes take the last number before them; those at the front the first one.
std::vector<double> filled_temperatures(const std::vector<float>& lossy) {
  const auto first = std::ranges::find_if(lossy, [](float t) { return std::isfinite(t); });
  if (first == lossy.end()) return {};
  double latest = double{*first};
  std::vector<double> filled;
  filled.reserve(lossy.size());
  for (const float temperature : lossy) {
    if (std::isfinite(temperature)) latest = double{temperature};
    filled.push_back(latest);
  }
  return filled;
}

}  // namespace

Record record_of(const identify::RestSamples& samples, std::size_t axis) {
  Record record{.axis = samples.axis_count == 1 ? "rate" : std::string(1, "xyz"[axis]),
                .sample_period_s = static_cast<double>(samples.sample_period.ns()) * 1e-9};
  record.time_s.reserve(samples.time.size());
  record.rate_rad_s.reserve(samples.time.size());
  for (std::size_t k = 0; k < samples.time.size(); ++k) {
    const core::Duration since_start = samples.time[k] - samples.time.front();
    record.time_s.push_back(static_cast<double>(since_start.ns()) * 1e-9);
    record.rate_rad_s.push_back(double{samples.rate_rad_s[k][axis]});
  }
  record.temperature_degc = filled_temperatures(samples.temperature_degc);
  return record;
}

}  // namespace zerorate::diagnose
