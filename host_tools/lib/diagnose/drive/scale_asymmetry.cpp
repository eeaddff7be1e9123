#include <fmt/format.h>

#include <cmath>

#include "host_tools/lib/diagnose/drive/motion_effect.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

constexpr double kAsymmetryPrior = 0.003;

class ScaleAsymmetry final : public MotionEffect {
 public:
  [[nodiscard]] std::string_view name() const override { return "scale_asymmetry"; }
  [[nodiscard]] std::string obstacle(const DriveRecord& /*record*/) const override { return {}; }
  [[nodiscard]] std::vector<Variant> variants(const DriveRecord& record) const override {
    const double sign = record.vertical.sign;
    const auto path = [&](const DriveEvidence& drive) { return sign * drive.path_rad; };
    return {free_column(column_of(record, path), kAsymmetryPrior)};
  }
  [[nodiscard]] MotionDescription describe(const MotionFinding& finding) const override {
    const Estimate percent = with_slopes(finding.coefficients.front(), finding.freedom) * 100.0;
    return {
        .parameters = {percent.parameter("scale_asymmetry_percent")},
        .sentence = fmt::format(
            "Turns of both senses are measured with different scale factors: half the difference "
            "is {:.3g} % [{:.3g}, {:.3g}].",
            percent.value, percent.lo(), percent.hi())};
  }
  std::string add_to_model(const MotionFinding& finding, model::SensorModel& model) const override {
    const Estimate error = with_slopes(finding.coefficients.front(), finding.freedom);
    model::ScaleFactor scale = model.scale_factor.value_or(model::ScaleFactor{});
    scale.asymmetry_sigma = std::hypot(error.value, error.sigma);
    scale.source = "identified by the turns of drives by zerorate diagnose";
    model.scale_factor = scale;
    return {};
  }
};

}  // namespace

std::unique_ptr<MotionEffect> make_scale_asymmetry() {
  return std::make_unique<ScaleAsymmetry>();
}

}  // namespace zerorate::diagnose
