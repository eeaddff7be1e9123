#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host_tools/lib/diagnose/drive/trace_effect.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

/// A gap in which the vehicle turns less spoils no heading.
constexpr double kLeastTurn_rad = 2.0 * units::kRadPerDeg;

/// Rows that are missing while the vehicle turns.
class GapInTurn final : public TraceEffect {
 public:
  [[nodiscard]] std::string_view name() const override { return "gap_in_turn"; }
  [[nodiscard]] std::optional<TraceFinding> find(const Trace& trace) const override {
    TraceFinding finding;
    double missing_s = 0.0;
    double turned_rad = 0.0;
    for (const TracedDrive& drive : trace.drives) {
      double by_drive_rad = 0.0;
      for (const Interval& gap : trace.gaps) {
        if (!gap.overlaps(drive.moving)) continue;
        const double turn_rad = turn_in(trace, drive, gap);
        if (turn_rad < kLeastTurn_rad) continue;
        by_drive_rad += turn_rad;
        missing_s += gap.length_s();
      }
      if (by_drive_rad == 0.0) continue;
      turned_rad += by_drive_rad;
      finding.drives.push_back(drive.number);
    }
    if (finding.drives.empty()) return std::nullopt;
    finding.parameters = {
        exact("drives_with_gap", static_cast<double>(finding.drives.size())),
        exact("missing_s", missing_s),
        exact("turned_meanwhile_deg", turned_rad * units::kDegPerRad),
    };
    finding.sentence = fmt::format(
        "Rows are missing while the vehicle turns, {:.2g} s in all, in which it turns by some "
        "{:.2g} deg: drives that depart at {}.",
        missing_s, turned_rad * units::kDegPerRad, departures(trace, finding.drives));
    finding.left_out_because = "no model replaces rows that are missing";
    return finding;
  }

 private:
  /// Turn during a gap, by the reference or else by the rates on both sides.
  static double turn_in(const Trace& trace, const TracedDrive& drive, const Interval& gap) {
    if (const auto turns = trace.turns(drive, gap)) {
      return std::max(std::abs(turns->reference_rad), std::abs(turns->gyro_rad));
    }
    return std::abs(*trace.gyro_rad.at(gap.to_ns, INT64_MAX) -
                    *trace.gyro_rad.at(gap.from_ns, INT64_MAX) - drive.bias_rad_s * gap.length_s());
  }
};

}  // namespace

std::unique_ptr<TraceEffect> make_gap_in_turn() {
  return std::make_unique<GapInTurn>();
}

}  // namespace zerorate::diagnose
