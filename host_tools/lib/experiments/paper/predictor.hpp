/// @file
/// Participant of an experiment: anything that turns a calibration into predictions.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace zerorate::experiments {

/// How long a set is, in samples.
struct Lengths {
  std::size_t calibration = 1000;
  std::size_t prediction = 1000;

  [[nodiscard]] std::size_t total() const { return calibration + prediction; }
};

/// Predictions for several sets; a column a set.
struct Forecasts {
  Eigen::MatrixXd bias;  ///< prediction length x sets
  /// Standard deviation of a raw sample about its prediction under the noise model: as large as
  /// `bias`, or a single column that holds for all sets.
  Eigen::MatrixXd sigma;
  /// Sigma as the method itself states it, where that differs: the method takes as certain what it
  /// estimated. Empty otherwise.
  Eigen::MatrixXd own_sigma;
  /// Mean normalised innovation squared of each set's calibration; empty if there is no such thing.
  std::vector<double> nis;
};

/// One predictor, set up for one noise model and one pair of lengths.
class Predictor {
 public:
  /// @param linear predictions are weighted sums of the calibration samples
  Predictor(std::string name, bool linear) : name_(std::move(name)), linear_(linear) {}
  virtual ~Predictor() = default;
  Predictor(const Predictor&) = delete;
  Predictor& operator=(const Predictor&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool is_linear() const { return linear_; }
  /// @param calibration calibration length x sets. May be called by several threads at once.
  [[nodiscard]] virtual Forecasts predict(const Eigen::MatrixXd& calibration) const = 0;

 private:
  std::string name_;
  bool linear_;
};

}  // namespace zerorate::experiments
