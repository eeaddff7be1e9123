#include "host_tools/lib/diagnose/record/record.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "host_tools/lib/identify/near_zero_mean.hpp"

namespace zerorate::diagnose {
namespace {

/// Holes take the last number before them; those at the front the first one.
std::vector<double> filled_temperatures(std::span<const float> lossy) {
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

/// Samples from `first` up to `end`.
struct Standstill {
  std::size_t first = 0;
  std::size_t end = 0;
};

Standstill longest_standstill(const identify::RestSamples& samples) {
  Standstill longest;
  std::size_t first = 0;
  const auto close = [&](std::size_t end) {
    if (end - first > longest.end - longest.first) longest = {first, end};
    first = end;
  };
  for (const std::size_t next : samples.after_drives) close(next);
  close(samples.time.size());
  return longest;
}

Record record_as_it_is(const identify::RestSamples& samples, std::size_t axis) {
  Record record{.axis = samples.axis_name(axis),
                .sample_period_s = static_cast<double>(samples.sample_period.ns()) * 1e-9,
                .mean_period_s = static_cast<double>(samples.mean_period.ns()) * 1e-9,
                .standstills = samples.after_drives.size() + 1,
                .inputs = input_ticks_of(samples),
                .index = axis};
  const auto [first, end] = longest_standstill(samples);
  record.time_s.reserve(end - first);
  record.rate_rad_s.reserve(end - first);
  for (std::size_t k = first; k < end; ++k) {
    const core::Duration since_start = samples.time[k] - samples.time.front();
    record.time_s.push_back(static_cast<double>(since_start.ns()) * 1e-9);
    record.rate_rad_s.push_back(double{samples.rate_rad_s[k][axis]});
  }
  if (!samples.temperature_degc.empty()) {
    record.temperature_degc =
        filled_temperatures(std::span{samples.temperature_degc}.subspan(first, end - first));
  }
  return record;
}

}  // namespace

Record record_of(const identify::RestSamples& samples, std::size_t axis) {
  TruncationEvidence truncation = find_truncation(samples);
  Record record = truncation.found
                      ? record_as_it_is(without_truncation(samples, *truncation.found), axis)
                      : record_as_it_is(samples, axis);
  record.truncation = truncation;
  return record;
}

std::vector<Record> records_of(const identify::RestSamples& samples,
                               std::span<const std::size_t> axes,
                               const identify::AcceptedDoubts& accepted) {
  std::vector<std::size_t> without_bias;
  if (!accepted.has(identify::doubt::kBias)) without_bias = identify::axes_without_bias(samples);
  std::vector<Record> records;
  records.reserve(axes.size());
  for (const std::size_t axis : axes) {
    records.push_back(record_of(samples, axis));
    identify::require_besides_motion(samples, records.back().size(), kFewestSamples,
                                     "samples in the longest standstill");
    records.back().is_bias_taken_out = std::ranges::find(without_bias, axis) != without_bias.end();
  }
  return records;
}

identify::RestSamples samples_of(const Record& record) {
  const auto nanoseconds = [](double seconds) { return std::llround(seconds * 1e9); };
  identify::RestSamples samples{
      .axis_count = 1,
      .sample_period = core::Duration::nanoseconds(nanoseconds(record.sample_period_s)),
      .mean_period = core::Duration::nanoseconds(nanoseconds(record.mean_period_s))};
  samples.time.reserve(record.size());
  samples.rate_rad_s.reserve(record.size());
  for (std::size_t k = 0; k < record.size(); ++k) {
    samples.time.push_back(core::Instant::from_ns(nanoseconds(record.time_s[k])));
    samples.rate_rad_s.push_back({static_cast<float>(record.rate_rad_s[k])});
  }
  return samples;
}

Record beginning_of(const Record& record, std::size_t size) {
  const auto first = [&](const std::vector<double>& values) {
    const auto count = static_cast<std::ptrdiff_t>(std::min(size, values.size()));
    return std::vector<double>(values.begin(), values.begin() + count);
  };
  return {.axis = record.axis,
          .sample_period_s = record.sample_period_s,
          .mean_period_s = record.mean_period_s,
          .time_s = first(record.time_s),
          .rate_rad_s = first(record.rate_rad_s),
          .temperature_degc = first(record.temperature_degc),
          .standstills = record.standstills,
          .inputs = record.inputs,
          .index = record.index,
          .truncation = record.truncation,
          .is_bias_taken_out = record.is_bias_taken_out};
}

}  // namespace zerorate::diagnose
