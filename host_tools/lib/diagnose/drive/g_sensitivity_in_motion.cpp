#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host_tools/lib/diagnose/drive/motion_effect.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

constexpr double kForcePrior_rad_s = 0.1 * units::kRadPerDeg;
/// An axis along which the force changes by less on the average shows nothing [g, rms].
constexpr double kLeastForce_g = 0.003;

std::vector<std::size_t> axes_with_forces(const DriveRecord& record) {
  std::vector<std::size_t> axes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double squares = 0.0;
    for (const DriveEvidence& drive : record.drives) {
      squares += std::pow(drive.force_g_s.at(axis) / drive.length_s, 2);
    }
    if (std::sqrt(squares / static_cast<double>(record.size())) > kLeastForce_g)
      axes.push_back(axis);
  }
  return axes;
}

class GSensitivityInMotion final : public MotionEffect {
 public:
  [[nodiscard]] std::string_view name() const override { return "g_sensitivity"; }
  [[nodiscard]] std::string obstacle(const DriveRecord& record) const override {
    if (!record.has_acceleration) return "no acceleration";
    return axes_with_forces(record).empty() ? "the forces do not change" : "";
  }
  [[nodiscard]] std::vector<Variant> variants(const DriveRecord& record) const override {
    const auto axes = axes_with_forces(record);
    const double sign = record.vertical.sign;
    Variant variant{
        .by = {},
        .share = {.columns = Eigen::MatrixXd(static_cast<Eigen::Index>(record.rows()),
                                             static_cast<Eigen::Index>(axes.size())),
                  .known = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(record.rows()))},
        .prior_sigma =
            Eigen::VectorXd::Constant(static_cast<Eigen::Index>(axes.size()), kForcePrior_rad_s)};
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const auto force = [&](const DriveEvidence& drive) {
        return sign * drive.force_g_s.at(axes[i]);
      };
      variant.share.columns.col(static_cast<Eigen::Index>(i)) = column_of(record, force);
    }
    return {variant};
  }
  [[nodiscard]] MotionDescription describe(const MotionFinding& finding) const override {
    const auto axes = axes_with_forces(*finding.record);
    MotionDescription description;
    std::string told;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const Estimate along = finding.coefficients[i] * units::kDegPerRad;
      description.parameters.push_back(
          along.parameter(fmt::format("along_{}_dps_per_g", "xyz"[axes[i]])));
      told +=
          fmt::format("{}{:.2g} along {}", told.empty() ? "" : ", ", along.value, "xyz"[axes[i]]);
    }
    description.sentence =
        fmt::format("On the way the bias follows the acceleration, by {} deg/s per g.", told);
    return description;
  }
  std::string add_to_model(const MotionFinding& finding, model::SensorModel& model) const override {
    using model::InputQuantity;
    constexpr std::array kQuantities{InputQuantity::acceleration_x, InputQuantity::acceleration_y,
                                     InputQuantity::acceleration_z};
    const bool is_known = std::ranges::any_of(model.inputs, [](const model::Input& input) {
      return input.quantity <= InputQuantity::acceleration_z;
    });
    if (is_known) return "the model has the sensitivity that the standstills show";
    const auto axes = axes_with_forces(*finding.record);
    for (std::size_t i = 0; i < axes.size(); ++i) {
      model::Input input{.quantity = kQuantities.at(axes[i]),
                         .sigma_rad_s_per_unit = finding.coefficients[i].sigma,
                         .source = "identified over drives by zerorate diagnose"};
      input.coefficient_rad_s_per_unit.at(finding.record->vertical.axis) =
          finding.coefficients[i].value;
      model.inputs.push_back(std::move(input));
    }
    return {};
  }
};

}  // namespace

std::unique_ptr<MotionEffect> make_g_sensitivity_in_motion() {
  return std::make_unique<GSensitivityInMotion>();
}

}  // namespace zerorate::diagnose
