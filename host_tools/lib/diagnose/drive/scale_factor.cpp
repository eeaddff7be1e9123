#include <fmt/format.h>

#include "host_tools/lib/diagnose/drive/motion_effect.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

constexpr double kScalePrior = 0.01;  ///< typical tolerance of a data sheet

class ScaleFactorError final : public MotionEffect {
 public:
  [[nodiscard]] std::string_view name() const override { return "scale_factor"; }
  [[nodiscard]] std::string obstacle(const DriveRecord& /*record*/) const override { return {}; }
  [[nodiscard]] std::vector<Variant> variants(const DriveRecord& record) const override {
    const auto turn = [](const DriveEvidence& drive) { return drive.turn_rad; };
    return {free_column(column_of(record, turn), kScalePrior)};
  }
  [[nodiscard]] MotionDescription describe(const MotionFinding& finding) const override {
    const Estimate percent = with_slopes(finding.coefficients.front(), finding.freedom) * 100.0;
    const bool is_small = percent.value < 0.0;
    const Estimate size = percent * (is_small ? -1.0 : 1.0);
    return {.parameters = {percent.parameter("scale_factor_error_percent")},
            .sentence = fmt::format(
                "Each turn is measured too {}, by {:.3g} % [{:.3g}, {:.3g}] of it: an error of the "
                "scale factor. The rate times {:.5f} is right.",
                is_small ? "small" : "large", size.value, size.lo(), size.hi(),
                1.0 / (1.0 + 0.01 * percent.value))};
  }
  std::string add_to_model(const MotionFinding& finding, model::SensorModel& model) const override {
    const Estimate error = with_slopes(finding.coefficients.front(), finding.freedom);
    model::ScaleFactor scale = model.scale_factor.value_or(model::ScaleFactor{});
    double& known = scale.error.at(finding.record->vertical.axis);
    known = (1.0 + known) * (1.0 + error.value) - 1.0;
    scale.sigma = error.sigma;
    scale.source = "identified by the turns of drives by zerorate diagnose";
    model.scale_factor = scale;
    return {};
  }
};

}  // namespace

std::unique_ptr<MotionEffect> make_scale_factor() {
  return std::make_unique<ScaleFactorError>();
}

}  // namespace zerorate::diagnose
