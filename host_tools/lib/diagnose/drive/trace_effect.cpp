#include "host_tools/lib/diagnose/drive/trace_effect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {

std::string departures(const Trace& trace, const std::vector<std::size_t>& drives) {
  constexpr std::size_t kMostTimes = 4;
  std::string text;
  std::size_t told = 0;
  for (const TracedDrive& drive : trace.drives) {
    if (std::ranges::find(drives, drive.number) == drives.end()) continue;
    if (told == kMostTimes) return text + " s and later";
    text += fmt::format("{}{:.0f}", told++ == 0 ? "" : ", ", units::seconds(drive.moving.from_ns));
  }
  return text + " s";
}

Parameter exact(std::string name, double value) {
  return {std::move(name), value, value, value};
}

std::vector<TraceFinding> find_in_trace(Trace trace) {
  std::vector<TraceFinding> findings;
  const auto look_for = [&](const std::unique_ptr<TraceEffect>& effect) {
    auto finding = effect->find(trace);
    if (!finding) return;
    finding->effect = effect->name();
    findings.push_back(*std::move(finding));
  };
  trace.delay_s = delay_of_reference(trace);
  look_for(make_reference_delay());
  look_for(make_gap_in_turn());
  look_for(make_saturation_in_turn());
  look_for(make_reference_fault());
  return findings;
}

}  // namespace zerorate::diagnose
