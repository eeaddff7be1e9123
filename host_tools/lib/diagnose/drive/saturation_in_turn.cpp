#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host_tools/lib/diagnose/drive/trace_effect.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

/// A full scale takes at least so much, and so large a share, off the turn.
constexpr double kLeastLoss_rad = 0.3 * units::kRadPerDeg;
constexpr double kLeastShare = 0.03;

/// Rates that stand at the full scale while the reference turns faster.
class SaturationInTurn final : public TraceEffect {
 public:
  [[nodiscard]] std::string_view name() const override { return "saturation_in_turn"; }
  [[nodiscard]] std::optional<TraceFinding> find(const Trace& trace) const override {
    TraceFinding finding;
    double clipped_s = 0.0;
    double lost_rad = 0.0;
    double limit_rad_s = 0.0;
    for (const TracedDrive& drive : trace.drives) {
      double by_drive_rad = 0.0;
      double turned_rad = 0.0;
      double by_drive_s = 0.0;
      for (const Interval& clipped : trace.clipped) {
        if (!clipped.overlaps(drive.moving)) continue;
        const auto turns = trace.turns(drive, widened(clipped, trace));
        if (!turns) continue;
        by_drive_s += clipped.length_s();
        turned_rad += std::abs(turns->gyro_rad);
        by_drive_rad += turns->parted_rad() * (turns->gyro_rad < 0.0 ? -1.0 : 1.0);
        limit_rad_s = std::max(limit_rad_s, rate_in(clipped, trace));
      }
      if (by_drive_rad < std::max(kLeastLoss_rad, kLeastShare * turned_rad)) continue;
      clipped_s += by_drive_s;
      lost_rad += by_drive_rad;
      finding.drives.push_back(drive.number);
    }
    if (finding.drives.empty()) return std::nullopt;
    finding.parameters = {
        exact("saturated_drives", static_cast<double>(finding.drives.size())),
        exact("full_scale_dps", limit_rad_s * units::kDegPerRad),
        exact("saturated_s", clipped_s),
        exact("lost_turn_deg", lost_rad * units::kDegPerRad),
    };
    finding.sentence = fmt::format(
        "The rate stands at its full scale of {:.3g} deg/s for {:.2g} s in turns, and misses "
        "{:.2g} "
        "deg of them: drives that depart at {}.",
        limit_rad_s * units::kDegPerRad, clipped_s, lost_rad * units::kDegPerRad,
        departures(trace, finding.drives));
    finding.left_out_because = "a rate beyond the full scale was not measured; choose a larger one";
    return finding;
  }

 private:
  /// With the intervals of the reference on both sides.
  static Interval widened(const Interval& clipped, const Trace& trace) {
    const auto beside_ns = static_cast<std::int64_t>(trace.reference_interval_s * 1e9);
    return {clipped.from_ns - beside_ns, clipped.to_ns + beside_ns};
  }
  static double rate_in(const Interval& clipped, const Trace& trace) {
    return std::abs(*trace.gyro_rad.at(clipped.to_ns, INT64_MAX) -
                    *trace.gyro_rad.at(clipped.from_ns, INT64_MAX)) /
           clipped.length_s();
  }
};

}  // namespace

std::unique_ptr<TraceEffect> make_saturation_in_turn() {
  return std::make_unique<SaturationInTurn>();
}

}  // namespace zerorate::diagnose
