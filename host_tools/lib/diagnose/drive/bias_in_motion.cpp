#include <fmt/format.h>

#include <cmath>

#include "host_tools/lib/diagnose/drive/motion_effect.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

constexpr double kOffsetPrior_rad_s = 0.01 * units::kRadPerDeg;
constexpr double kSpeed_m_s = 10.0;  ///< speed at which an offset by the metres is stated

constexpr std::string_view kByTime = "time";
constexpr std::string_view kByMetres = "metres";
constexpr std::string_view kByVibration = "vibration";

/// Vibration over all the time in motion [g^2].
double mean_vibration_g2(const DriveRecord& record) {
  double sum = 0.0;
  double moving_s = 0.0;
  for (const DriveEvidence& drive : record.drives) {
    sum += drive.vibration_g2_s;
    moving_s += drive.moving_s;
  }
  return moving_s > 0.0 ? sum / moving_s : 0.0;
}

class BiasInMotion final : public MotionEffect {
 public:
  [[nodiscard]] std::string_view name() const override { return "bias_in_motion"; }
  [[nodiscard]] std::string obstacle(const DriveRecord& /*record*/) const override { return {}; }
  [[nodiscard]] std::vector<Variant> variants(const DriveRecord& record) const override {
    const double sign = record.vertical.sign;
    const auto follows = [&](std::string_view by, auto figure) {
      const auto signed_figure = [&](const DriveEvidence& drive) { return sign * figure(drive); };
      return free_column(column_of(record, signed_figure), kOffsetPrior_rad_s, std::string(by));
    };
    std::vector<Variant> variants{
        follows(kByTime, [](const DriveEvidence& drive) { return drive.moving_s; }),
        follows(kByMetres, [](const DriveEvidence& drive) { return drive.metres / kSpeed_m_s; })};
    const double vibration_g2 = mean_vibration_g2(record);
    if (record.has_acceleration && vibration_g2 > 0.0) {
      variants.push_back(follows(kByVibration, [&](const DriveEvidence& drive) {
        return drive.vibration_g2_s / vibration_g2;
      }));
    }
    return variants;
  }
  [[nodiscard]] MotionDescription describe(const MotionFinding& finding) const override {
    const Estimate offset = finding.coefficients.front() * units::kDegPerRad;
    const std::string& by = finding.variant.by;
    const std::string interval =
        fmt::format("{:.3g} deg/s [{:.3g}, {:.3g}]", offset.value, offset.lo(), offset.hi());
    if (by == kByMetres) {
      return {{offset.parameter("offset_at_10_mps_dps")},
              fmt::format("In motion the bias is another than at rest, in proportion to the speed: "
                          "by {} at 10 m/s.",
                          interval)};
    }
    if (by == kByVibration) {
      return {{offset.parameter("offset_at_mean_vibration_dps")},
              fmt::format("In motion the bias is another than at rest, in proportion to the "
                          "vibration: by {} at the mean of these drives.",
                          interval)};
    }
    return {{offset.parameter("offset_in_motion_dps")},
            fmt::format("In motion the bias is another than at rest, by {}.", interval)};
  }
  std::string add_to_model(const MotionFinding& finding, model::SensorModel& model) const override {
    if (finding.variant.by != kByVibration) {
      return "a node has no input of the speed; references of the heading teach it the offset";
    }
    const Estimate per_g2 =
        finding.coefficients.front() * (1.0 / mean_vibration_g2(*finding.record));
    model::Input input{.quantity = model::InputQuantity::vibration,
                       .sigma_rad_s_per_unit = per_g2.sigma,
                       .source = "identified over drives by zerorate diagnose"};
    input.coefficient_rad_s_per_unit.at(finding.record->vertical.axis) = per_g2.value;
    model.inputs.push_back(std::move(input));
    return {};
  }
};

}  // namespace

std::unique_ptr<MotionEffect> make_bias_in_motion() {
  return std::make_unique<BiasInMotion>();
}

}  // namespace zerorate::diagnose
