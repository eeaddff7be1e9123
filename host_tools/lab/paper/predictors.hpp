/// @file
/// Participants of an experiment: anything that turns a calibration into predictions; the
/// predictors of host_tools/lab/reference, and those of the node (core/estimator, single
/// precision).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/noise/modes.hpp"
#include "host_tools/lab/reference/fractional_noise.hpp"

namespace zerorate::paper {

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

/// The paper's filter: one state a sample, the calibration mean as its mean. Its own band takes
/// that mean as certain.
[[nodiscard]] std::unique_ptr<Predictor> make_full_state(std::string name,
                                                         const reference::FractionalNoise& noise,
                                                         const Lengths& lengths);

/// The optimum of all linear predictors.
[[nodiscard]] std::unique_ptr<Predictor> make_optimum(std::string name,
                                                      const reference::FractionalNoise& noise,
                                                      reference::Bias bias, const Lengths& lengths);

enum class AutoregressionFit { least_squares, burg };

/// A model fitted to each calibration anew, and its iterated forecast. Its own band takes the
/// fitted mean and coefficients as certain. The other one is that of the forecast's weights under
/// `noise`, with the weights as given although they come from the data.
[[nodiscard]] std::unique_ptr<Predictor> make_autoregression(
    std::string name, AutoregressionFit fit, std::size_t order,
    const reference::FractionalNoise& noise, const Lengths& lengths);

/// How the node approximates fractional noise: one first-order lag a decade, from a time constant
/// of one sample on.
struct DecadeNoise {
  reference::FractionalNoise noise;
  double sample_period_s = 1.0;
  int decades = 5;
  core::Start start = core::Start::zero;
};

/// The Kalman filter with one state a decade and the bias.
[[nodiscard]] std::unique_ptr<Predictor> make_decade_kalman(std::string name,
                                                            const DecadeNoise& noise,
                                                            const Lengths& lengths);
/// Eq. 8 and 9, with the interval of docs/design/window-intervals.md.
[[nodiscard]] std::unique_ptr<Predictor> make_moving_average(std::string name,
                                                             const DecadeNoise& noise,
                                                             const Lengths& lengths);
/// Eq. 9 alone, with its interval.
[[nodiscard]] std::unique_ptr<Predictor> make_calibration_mean(std::string name,
                                                               const DecadeNoise& noise,
                                                               const Lengths& lengths);

}  // namespace zerorate::paper
