#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host_tools/lib/diagnose/drive/drive_diagnosis.hpp"
#include "host_tools/lib/diagnose/drive/motion_effect.hpp"
#include "host_tools/lib/diagnose/drive/trace_effect.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

constexpr double kMostDelay_s = 3.0;
constexpr double kCoarseStep_s = 0.25;
/// A shorter delay is that of a filter, or of rows between which a heading was taken.
constexpr double kLeastDelay_s = 0.02;

/// Length of windows that are shorter than a turn.
double window_length_s(const Trace& trace) {
  return std::max(1.0, trace.reference_interval_s);
}

/// Sum of the sizes by which reference and gyro part within windows of all drives.
double parted_in_all(const Trace& trace) {
  double sum_rad = 0.0;
  double windows = 0.0;
  for (const TracedDrive& drive : trace.drives) {
    for (const Interval& window : windows_in(drive.moving, window_length_s(trace))) {
      const auto turns = trace.turns(drive, window);
      if (!turns) continue;
      sum_rad += std::abs(turns->parted_rad());
      windows += 1.0;
    }
  }
  return windows > 0.0 ? sum_rad / windows : 0.0;
}

double coarse_delay_s(Trace trace) {
  double best_s = 0.0;
  double least_rad = parted_in_all(trace);
  for (double delay_s = -kMostDelay_s; delay_s <= kMostDelay_s; delay_s += kCoarseStep_s) {
    trace.delay_s = delay_s;
    const double parted_rad = parted_in_all(trace);
    if (!(parted_rad < least_rad)) continue;
    least_rad = parted_rad;
    best_s = delay_s;
  }
  return best_s;
}

/// A delay and its weight: the sum of the squared changes of the rate.
struct Lag {
  double delay_s;
  double weight;
};

/// Step of Gauss and Newton from the delay of the trace, in one drive.
std::optional<Lag> refined(const Trace& trace, const TracedDrive& drive) {
  constexpr double kProbe_s = 0.1;
  double jj = 0.0;
  double je = 0.0;
  const auto probe_ns = static_cast<std::int64_t>(kProbe_s * 1e9);
  for (const Interval& window : windows_in(drive.moving, window_length_s(trace))) {
    const auto now = trace.turns(drive, window);
    // The gyro's turns a little earlier and later: they have no steps.
    const auto early = trace.turns(drive, {window.from_ns - probe_ns, window.to_ns - probe_ns});
    const auto late = trace.turns(drive, {window.from_ns + probe_ns, window.to_ns + probe_ns});
    if (!now || !early || !late) continue;
    const double slope = (late->gyro_rad - early->gyro_rad) / (2.0 * kProbe_s);
    jj += slope * slope;
    je += slope * now->parted_rad();
  }
  if (!(jj > 0.0)) return std::nullopt;
  return Lag{trace.delay_s - je / jj, jj};
}

std::vector<Lag> lags_of(const Trace& trace) {
  std::vector<Lag> lags;
  for (const TracedDrive& drive : trace.drives) {
    if (const auto lag = refined(trace, drive)) lags.push_back(*lag);
  }
  return lags;
}

double weighted_median(std::vector<Lag> lags) {
  std::ranges::sort(lags, {}, &Lag::delay_s);
  const double half =
      0.5 * std::accumulate(lags.begin(), lags.end(), 0.0,
                            [](double sum, const Lag& lag) { return sum + lag.weight; });
  double sum = 0.0;
  for (const Lag& lag : lags) {
    sum += lag.weight;
    if (sum >= half) return lag.delay_s;
  }
  return 0.0;
}

/// The delay about which a trace has no delay any more.
Trace aligned(Trace trace) {
  constexpr int kSteps = 6;
  trace.delay_s = coarse_delay_s(trace);
  for (int i = 0; i < kSteps; ++i) {
    const std::vector<Lag> lags = lags_of(trace);
    if (lags.empty()) break;
    trace.delay_s = std::clamp(weighted_median(lags), -kMostDelay_s, kMostDelay_s);
  }
  return trace;
}

/// The middle of the drives with its error, those in which the reference is at fault left out.
Estimate delay_with_error(const Trace& trace) {
  std::vector<Lag> lags = lags_of(trace);
  std::vector<double> apart;
  apart.reserve(lags.size());
  for (const Lag& lag : lags) apart.push_back(std::abs(lag.delay_s - trace.delay_s));
  constexpr double kWide = 6.0;
  constexpr double kAlike_s = 0.01;
  const double most_s = kWide * (apart.empty() ? 0.0 : statistics::median_of(apart)) + kAlike_s;
  std::erase_if(lags,
                [&](const Lag& lag) { return std::abs(lag.delay_s - trace.delay_s) > most_s; });
  double weights = 0.0;
  double mean_s = 0.0;
  for (const Lag& lag : lags) {
    weights += lag.weight;
    mean_s += lag.weight * lag.delay_s;
  }
  mean_s /= weights;
  double squares = 0.0;
  for (const Lag& lag : lags) squares += std::pow(lag.weight / weights * (lag.delay_s - mean_s), 2);
  const double freedom = static_cast<double>(lags.size()) - 1.0;
  if (!(freedom > 0.0)) return {mean_s, HUGE_VAL, HUGE_VAL};
  const double sigma_s = std::sqrt(squares * (freedom + 1.0) / freedom);
  return {mean_s, student_half_width95(freedom) * sigma_s, sigma_s};
}

/// Headings that are older, or newer, than their time. The trace is aligned: delay_of_reference().
class ReferenceDelay final : public TraceEffect {
 public:
  [[nodiscard]] std::string_view name() const override { return "reference_delay"; }
  [[nodiscard]] std::optional<TraceFinding> find(const Trace& trace) const override {
    if (trace.drives.size() < kFewestDrives) return std::nullopt;
    const Estimate delay = delay_with_error(trace);
    const double least_s = std::max(kLeastDelay_s, trace.row_interval_s);
    if (!(std::abs(delay.value) - delay.half_width > least_s)) return std::nullopt;
    const auto freedom = static_cast<double>(trace.drives.size()) - 1.0;
    const double surprisal =
        -std::log(2.0) - statistics::log_student_tail(std::abs(delay.value) / delay.sigma, freedom);
    if (surprisal < kDriveThreshold_nats) return std::nullopt;
    return TraceFinding{
        .surprisal_nats = std::min(surprisal, kPlain_nats),
        .parameters = {delay.parameter("delay_s")},
        .sentence = fmt::format(
            "The reference's heading is {} by {:.3g} s [{:.3g}, {:.3g}]: within turns it parts "
            "from "
            "the gyro in proportion to the rate. The errors from stop to stop are free of it.",
            delay.value > 0.0 ? "late" : "ahead", std::abs(delay.value),
            std::abs(delay.value) - delay.half_width, std::abs(delay.value) + delay.half_width),
        .left_out_because = "a model describes the gyro; correct the times of the reference",
        .delay_s = delay.value};
  }
};

}  // namespace

double delay_of_reference(const Trace& trace) {
  return trace.drives.empty() ? 0.0 : aligned(trace).delay_s;
}

std::unique_ptr<TraceEffect> make_reference_delay() {
  return std::make_unique<ReferenceDelay>();
}

}  // namespace zerorate::diagnose
