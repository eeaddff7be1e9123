/// @file
/// Effects that only a moving sensor shows.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/diagnose/drive/drive_record.hpp"
#include "host_tools/lib/diagnose/drive/regression.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

/// One way in which an effect may make its share of the errors.
struct Variant {
  std::string by;  ///< quantity that it follows, where an effect has several; else empty
  Share share;
  /// Standard deviation of each coefficient over parts of a kind, as data sheets let expect.
  Eigen::VectorXd prior_sigma;
  /// Log likelihood that the effect gains by what is measured beside the errors of the heading.
  double own_nats = 0.0;
};

/// A figure with its 95 % interval.
struct Estimate {
  double value = 0.0;
  double half_width = 0.0;
  double sigma = 0.0;

  [[nodiscard]] double lo() const { return value - half_width; }
  [[nodiscard]] double hi() const { return value + half_width; }
  [[nodiscard]] Estimate operator*(double factor) const {
    return {value * factor, half_width * std::abs(factor), sigma * std::abs(factor)};
  }
  [[nodiscard]] Parameter parameter(std::string name) const {
    return {std::move(name), value, lo(), hi()};
  }
};

/// Half of the 95 % interval of Student's t over its standard deviation.
[[nodiscard]] double student_half_width95(double freedom);

/// A share of the turns, with what slopes add to its error: on a grade of 3 % the axis measures
/// 0.045 % less of a turn, and some of the turns lie on one.
[[nodiscard]] Estimate with_slopes(const Estimate& share, double freedom);

/// An effect as it was fitted.
struct MotionFinding {
  const DriveRecord* record = nullptr;
  Variant variant;
  std::vector<Estimate> coefficients;
  double freedom = 0.0;  ///< drives less coefficients
};

struct MotionDescription {
  std::vector<Parameter> parameters;
  std::string sentence;
};

class MotionEffect {
 public:
  MotionEffect() = default;
  MotionEffect(const MotionEffect&) = delete;
  MotionEffect& operator=(const MotionEffect&) = delete;
  MotionEffect(MotionEffect&&) = delete;
  MotionEffect& operator=(MotionEffect&&) = delete;
  virtual ~MotionEffect() = default;

  [[nodiscard]] virtual std::string_view name() const = 0;
  /// Reason why a record cannot show the effect; empty where it can.
  [[nodiscard]] virtual std::string obstacle(const DriveRecord& record) const = 0;
  /// Ways in which the effect may show in a record.
  [[nodiscard]] virtual std::vector<Variant> variants(const DriveRecord& record) const = 0;
  [[nodiscard]] virtual MotionDescription describe(const MotionFinding& finding) const = 0;
  /// Adds the effect to the model of the node.
  /// @return reason why the model cannot have it; empty where it has
  virtual std::string add_to_model(const MotionFinding& finding,
                                   model::SensorModel& model) const = 0;
};

/// A column of a figure of each row: of the drives, and then of the windows.
template <class Figure>
[[nodiscard]] Eigen::VectorXd column_of(const DriveRecord& record, const Figure& figure) {
  Eigen::VectorXd column(static_cast<Eigen::Index>(record.rows()));
  for (std::size_t i = 0; i < record.rows(); ++i) {
    column[static_cast<Eigen::Index>(i)] = figure(record.row(i));
  }
  return column;
}

/// A variant of one column with a free coefficient.
[[nodiscard]] Variant free_column(const Eigen::VectorXd& column, double prior_sigma,
                                  std::string by = {});

[[nodiscard]] std::unique_ptr<MotionEffect> make_scale_factor();
[[nodiscard]] std::unique_ptr<MotionEffect> make_scale_asymmetry();
[[nodiscard]] std::unique_ptr<MotionEffect> make_bias_in_motion();
[[nodiscard]] std::unique_ptr<MotionEffect> make_misalignment();
[[nodiscard]] std::unique_ptr<MotionEffect> make_g_sensitivity_in_motion();

/// All of them.
[[nodiscard]] std::vector<std::unique_ptr<MotionEffect>> make_motion_effects();

}  // namespace zerorate::diagnose
