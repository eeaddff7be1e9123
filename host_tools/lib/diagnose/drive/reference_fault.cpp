#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host_tools/lib/diagnose/drive/trace_effect.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kRadPerDeg;

/// Slowest rate of a turn.
constexpr double kTurning_rad_s = 2.0 * kRadPerDeg;
/// Turn that a reference may miss, or give the other way, in one place.
constexpr double kMostMissed_rad = 15.0 * kRadPerDeg;
/// Largest step that is none.
constexpr double kLeastJump_rad = 1.0 * kRadPerDeg;
/// Standard deviation of normal figures over the median of their sizes.
constexpr double kSigmaPerMedianSize = 1.4826;
/// Time on both sides of a step in which it has to last.
constexpr double kBeside_s = 2.0;

bool has_lost_rows(const Trace& trace, const Interval& window) {
  const auto overlaps = [&](const Interval& other) { return other.overlaps(window); };
  return std::ranges::any_of(trace.gaps, overlaps) || std::ranges::any_of(trace.clipped, overlaps);
}

/// Largest turn of the gyro in windows in succession that a reference gives in a wrong way.
/// @param is_wrong of the turns in a window
template <class Predicate>
double longest_run_rad(const Trace& trace, const TracedDrive& drive, const Predicate& is_wrong) {
  const double length_s = std::max(0.5, 2.0 * trace.reference_interval_s);
  double longest_rad = 0.0;
  double run_rad = 0.0;
  int windows = 0;
  for (const Interval& window : windows_in(drive.moving, length_s)) {
    const auto turns = trace.turns(drive, window);
    const bool continues = turns &&
                           std::abs(turns->gyro_rad) > kTurning_rad_s * window.length_s() &&
                           is_wrong(*turns) && !has_lost_rows(trace, window);
    run_rad = continues ? run_rad + std::abs(turns->gyro_rad) : 0.0;
    windows = continues ? windows + 1 : 0;
    if (windows >= 2) longest_rad = std::max(longest_rad, run_rad);
  }
  return longest_rad;
}

/// The reference stands while the gyro turns.
bool is_frozen(const Trace& trace, const TracedDrive& drive) {
  constexpr double kShare = 0.1;
  return longest_run_rad(trace, drive, [](const TurnPair& turns) {
           return std::abs(turns.reference_rad) < kShare * std::abs(turns.gyro_rad);
         }) > kMostMissed_rad;
}

/// The reference turns as fast as the gyro, the other way.
bool is_turned_over(const Trace& trace, const TracedDrive& drive) {
  constexpr double kShare = 0.25;
  return longest_run_rad(trace, drive, [](const TurnPair& turns) {
           return std::abs(turns.reference_rad + turns.gyro_rad) <
                  kShare * std::abs(turns.gyro_rad);
         }) > kMostMissed_rad;
}

/// Turns of reference and gyro around a step, which show whether they part for good.
std::optional<TurnPair> turns_beside(const Trace& trace, const TracedDrive& drive,
                                     const Interval& step) {
  const auto beside_ns =
      static_cast<std::int64_t>(std::max(kBeside_s, 2.0 * trace.reference_interval_s) * 1e9);
  return trace.turns(drive, {step.from_ns - beside_ns, step.to_ns + beside_ns});
}

/// Parting that is usual around a time, robust standard deviation [rad].
double usual_parting_rad(const Trace& trace) {
  std::vector<double> sizes;
  for (const TracedDrive& drive : trace.drives) {
    for (const Interval& window : windows_in(drive.moving, 2.0)) {
      if (const auto turns = turns_beside(trace, drive, window))
        sizes.push_back(std::abs(turns->parted_rad()));
    }
  }
  return sizes.empty() ? 0.0 : kSigmaPerMedianSize * statistics::median_of(sizes);
}

/// Steps of the reference from one heading to the next, as the gyro's time goes.
class JumpSearch {
 public:
  explicit JumpSearch(const Trace& trace)
      : trace_(trace), least_rad_(std::max(kLeastJump_rad, 12.0 * usual_parting_rad(trace))) {}

  /// Size of the largest jump of the reference in a drive; 0: none.
  [[nodiscard]] double largest_rad(const TracedDrive& drive) const {
    const auto late_ns = static_cast<std::int64_t>(std::llround(trace_.delay_s * 1e9));
    const truth::Series& reference = trace_.reference_rad;
    double largest = 0.0;
    for (std::size_t k = std::max<std::size_t>(2, reference.first_from(drive.all.from_ns));
         k + 1 < reference.size() && reference.time_ns(k) <= drive.all.to_ns; ++k) {
      const Interval step{reference.time_ns(k - 1) - late_ns, reference.time_ns(k) - late_ns};
      if (!is_odd(k) || has_lost_rows(trace_, step)) continue;
      largest = std::max(largest, jump_at(drive, step));
    }
    return largest;
  }

 private:
  /// Whether the reference turned by another angle than just before and after.
  [[nodiscard]] bool is_odd(std::size_t k) const {
    const auto step = [&](std::size_t at) {
      return trace_.reference_rad.value(at) - trace_.reference_rad.value(at - 1);
    };
    return std::min(std::abs(step(k) - step(k - 1)), std::abs(step(k) - step(k + 1))) >
           0.5 * least_rad_;
  }
  [[nodiscard]] double jump_at(const TracedDrive& drive, const Interval& step) const {
    constexpr double kShareAtOnce = 0.6;
    constexpr double kShareOfTurn = 0.1;
    const auto at_once = trace_.turns(drive, step);
    const auto for_good = turns_beside(trace_, drive, step);
    if (!at_once || !for_good) return 0.0;
    const double size = std::abs(for_good->parted_rad());
    const bool is_one_step = at_once->parted_rad() / for_good->parted_rad() > kShareAtOnce;
    const bool is_by_gyro = std::abs(at_once->gyro_rad) > std::abs(at_once->reference_rad);
    const bool is_plain = size > std::max(least_rad_, kShareOfTurn * std::abs(at_once->gyro_rad));
    return is_one_step && is_plain && !is_by_gyro ? size : 0.0;
  }

  const Trace& trace_;
  double least_rad_;
};

/// A reference that stands, turns the other way or jumps in single drives.
class ReferenceFault final : public TraceEffect {
 public:
  [[nodiscard]] std::string_view name() const override { return "reference_fault"; }
  [[nodiscard]] std::optional<TraceFinding> find(const Trace& trace) const override {
    const JumpSearch jumps{trace};
    TraceFinding finding;
    std::vector<std::size_t> frozen;
    std::vector<std::size_t> turned_over;
    std::vector<std::size_t> jumped;
    double largest_rad = 0.0;
    for (const TracedDrive& drive : trace.drives) {
      if (is_frozen(trace, drive)) {
        frozen.push_back(drive.number);
      } else if (is_turned_over(trace, drive)) {
        turned_over.push_back(drive.number);
      } else if (const double jump_rad = jumps.largest_rad(drive); jump_rad > 0.0) {
        jumped.push_back(drive.number);
        largest_rad = std::max(largest_rad, jump_rad);
      } else {
        continue;
      }
      finding.drives.push_back(drive.number);
    }
    if (finding.drives.empty()) return std::nullopt;
    finding.sentence = "The reference is at fault, not the gyro:";
    add_kind(trace, frozen, "frozen_drives", "it stands while the gyro turns", finding);
    add_kind(trace, turned_over, "wrong_sign_drives", "it turns the other way", finding);
    add_kind(trace, jumped, "jump_drives",
             fmt::format("it jumps, by up to {:.2g} deg", largest_rad * units::kDegPerRad),
             finding);
    finding.sentence.back() = '.';
    finding.left_out_because = "a model describes the gyro";
    return finding;
  }

 private:
  static void add_kind(const Trace& trace, const std::vector<std::size_t>& drives,
                       const char* parameter, const std::string& what, TraceFinding& finding) {
    if (drives.empty()) return;
    finding.parameters.push_back(exact(parameter, static_cast<double>(drives.size())));
    finding.sentence +=
        fmt::format(" {} in drives that depart at {};", what, departures(trace, drives));
  }
};

}  // namespace

std::unique_ptr<TraceEffect> make_reference_fault() {
  return std::make_unique<ReferenceFault>();
}

}  // namespace zerorate::diagnose
