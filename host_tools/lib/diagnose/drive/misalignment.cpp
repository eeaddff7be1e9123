#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include <algorithm>
#include <array>
#include <cmath>

#include "host_tools/lib/diagnose/drive/drive_diagnosis.hpp"
#include "host_tools/lib/diagnose/drive/motion_effect.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

/// Share of a turn that one of the other axes measures, and how much likelier its measurements are
/// with it.
struct Component {
  Estimate sine;
  double gain_nats = 0.0;
};

/// Component of the vertical along one of the other axes. A body that leans outwards in curves
/// shows it a share of the path.
Component component_of(const DriveRecord& record, std::size_t axis) {
  const auto drives = static_cast<Eigen::Index>(record.size());
  const auto of_drives = [&](const auto& figure) {
    return column_of(record, figure).head(drives).eval();
  };
  Eigen::MatrixXd x(drives, 2);
  x.col(0) = of_drives([](const DriveEvidence& drive) { return drive.turn_rad; });
  x.col(1) = of_drives([](const DriveEvidence& drive) { return drive.path_rad; });
  const Eigen::VectorXd y =
      of_drives([&](const DriveEvidence& drive) { return drive.turned_rad.at(axis); });
  const Eigen::Matrix2d inverse =
      (x.transpose() * x).completeOrthogonalDecomposition().pseudoInverse();
  const Eigen::Vector2d shares = inverse * (x.transpose() * y);
  const double freedom = static_cast<double>(record.size()) - 2.0;
  const Eigen::VectorXd left = y - x * shares;
  const double squares = left.squaredNorm();
  // Slopes and lean make the errors of some drives larger: each counts by its own residual, as it
  // would be of a fit to the other drives (HC3, MacKinnon and White 1985).
  double variance = 0.0;
  for (Eigen::Index k = 0; k < drives; ++k) {
    const Eigen::Vector2d row = x.row(k).transpose();
    const double influence = inverse.row(0).dot(row);
    variance += std::pow(influence * left[k] / (1.0 - row.dot(inverse * row)), 2);
  }
  const double sigma = std::sqrt(variance);
  // Without the share the squares are larger by what a single column takes.
  const double squares_without = squares + shares[0] * shares[0] / inverse(0, 0);
  return {
      .sine = {shares[0], student_half_width95(freedom) * sigma, sigma},
      .gain_nats = 0.5 * static_cast<double>(record.size()) * std::log(squares_without / squares)};
}

/// Tilt of the vertical axis, by what the two others measure of the turns.
struct MeasuredTilt {
  std::array<Estimate, 2> sines;
  std::array<std::size_t, 2> axes;
  double gain_nats = 0.0;

  /// The square of the sine without what errors add to it; 0 where it is within them.
  [[nodiscard]] double squared_sine() const {
    double squares = 0.0;
    double errors = 0.0;
    for (const Estimate& sine : sines) {
      squares += sine.value * sine.value;
      errors += sine.sigma * sine.sigma;
    }
    constexpr double kPlain = 9.0;  // three standard deviations of both
    return squares > kPlain * errors ? squares - errors : 0.0;
  }
  [[nodiscard]] double loss() const { return 1.0 - std::sqrt(1.0 - std::min(squared_sine(), 1.0)); }
};

/// Whether a share of the errors that is known is worth a cause, whatever else is in them.
bool is_material(const DriveRecord& record, const Eigen::VectorXd& share_rad) {
  return 0.5 * share_rad.dot(record.covariance().llt().solve(share_rad)) >= kDriveThreshold_nats;
}

MeasuredTilt tilt_of(const DriveRecord& record) {
  const std::size_t vertical = record.vertical.axis;
  const std::array<std::size_t, 2> axes{(vertical + 1) % 3, (vertical + 2) % 3};
  const Component first = component_of(record, axes[0]);
  const Component second = component_of(record, axes[1]);
  return {{first.sine, second.sine}, axes, first.gain_nats + second.gain_nats};
}

class Misalignment final : public MotionEffect {
 public:
  [[nodiscard]] std::string_view name() const override { return "misalignment"; }
  [[nodiscard]] std::string obstacle(const DriveRecord& record) const override {
    if (record.axis_count < 3) return "one axis";
    return tilt_of(record).squared_sine() > 0.0 ? ""
                                                : "the other axes measure no share of the turns";
  }
  /// The other axes measure the tilt, so that its share of the errors is known.
  [[nodiscard]] std::vector<Variant> variants(const DriveRecord& record) const override {
    const MeasuredTilt tilt = tilt_of(record);
    // The turn about the vertical is the sum of its components over all axes.
    const auto share = [&](const DriveEvidence& drive) {
      double rad = tilt.loss() * record.vertical.sign * drive.turned_rad.at(record.vertical.axis);
      for (std::size_t i = 0; i < 2; ++i) {
        rad -= tilt.sines[i].value * drive.turned_rad.at(tilt.axes[i]);
      }
      return rad;
    };
    Variant variant{
        .by = {}, .share = {.columns = {}, .known = column_of(record, share)}, .prior_sigma = {}};
    if (is_material(record, variant.share.known)) variant.own_nats = tilt.gain_nats;
    return {variant};
  }
  [[nodiscard]] MotionDescription describe(const MotionFinding& finding) const override {
    const MeasuredTilt tilt = tilt_of(*finding.record);
    const double sine = std::sqrt(tilt.squared_sine());
    // The error of the angle is that of the share in its own direction.
    double sigma = 0.0;
    double half_width = 0.0;
    for (const Estimate& one : tilt.sines) {
      sigma = std::hypot(sigma, one.value * one.sigma / sine);
      half_width = std::hypot(half_width, one.value * one.half_width / sine);
    }
    const double per_sine = units::kDegPerRad / std::sqrt(1.0 - sine * sine);
    const Estimate angle{std::asin(sine) * units::kDegPerRad, half_width * per_sine,
                         sigma * per_sine};
    MotionDescription description{
        .parameters = {angle.parameter("tilt_deg")},
        .sentence = fmt::format("The axis stands askew by {:.3g} deg [{:.3g}, {:.3g}], by what the "
                                "other axes measure of "
                                "the turns, and measures {:.3g} % less of them.",
                                angle.value, angle.lo(), angle.hi(), 100.0 * tilt.loss())};
    for (std::size_t i = 0; i < 2; ++i) {
      description.parameters.push_back(
          (tilt.sines[i] * 100.0)
              .parameter(fmt::format("turn_on_{}_percent", "xyz"[tilt.axes[i]])));
    }
    return description;
  }
  std::string add_to_model(const MotionFinding& finding, model::SensorModel& model) const override {
    model::ScaleFactor scale = model.scale_factor.value_or(model::ScaleFactor{});
    double& known = scale.error.at(finding.record->vertical.axis);
    known = (1.0 + known) * (1.0 - tilt_of(*finding.record).loss()) - 1.0;
    scale.source = "cosine of the tilt, identified over drives by zerorate diagnose";
    model.scale_factor = scale;
    return {};
  }
};

}  // namespace

std::unique_ptr<MotionEffect> make_misalignment() {
  return std::make_unique<Misalignment>();
}

}  // namespace zerorate::diagnose
