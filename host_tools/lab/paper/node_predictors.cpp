#include "host_tools/lab/paper/predictors.hpp"

#include <algorithm>
#include <cmath>

#include "core/estimator/bias_predictor.hpp"
#include "core/estimator/calibration_mean.hpp"
#include "core/estimator/kalman_predictor.hpp"
#include "core/estimator/moving_average.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tools/lib/spectrum/noise_strength.hpp"

namespace zerorate::paper {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr std::size_t kMostDecades = 8;
using Node = model::NodeModel<core::ModelShape{.decaying = kMostDecades}>;
using Span = core::Transition<kMostDecades, 0>;

/// The node's filter never trusts a sample completely. Where neither the noise nor the fit of the
/// lags leaves anything white, a hundredth of s_f stands in.
double white_variance(const reference::FractionalNoise& noise) {
  return std::max(noise.white_variance, 1e-4 * noise.innovation_variance);
}

Node make_node(const DecadeNoise& decades) {
  const auto& noise = decades.noise;
  const double period_s = decades.sample_period_s;
  const model::SensorModel sensor{
      .name = "fractional noise",
      .white = {.angle_random_walk_rad_per_sqrt_s =
                    spectrum::angle_random_walk(white_variance(noise), period_s)},
      .flicker = model::Flicker{.bias_instability_rad_s = spectrum::bias_instability(
                                    noise.innovation_variance, noise.order, period_s),
                                .order = noise.order,
                                .decades = decades.decades,
                                .shortest_time_constant_s = period_s},
      .node = {.start = decades.start}};
  const auto tick = core::Duration::nanoseconds(std::llround(period_s * 1e9));
  return model::make_node_model<core::ModelShape{.decaying = kMostDecades}>(sensor, tick, tick);
}

/// Predictor P of the core, as the node feeds it: one tick a sample.
template <core::BiasPredictor P>
class OnNode : public Predictor {
 public:
  OnNode(std::string name, const Node& node, const Lengths& lengths)
      : Predictor(std::move(name), true), node_(node), tick_(node.modes.one_tick()) {
    leads_.push_back(tick_);
    while (leads_.size() < lengths.prediction) leads_.push_back(then(leads_.back(), tick_));
    state_sigmas(lengths);
  }

  [[nodiscard]] Forecasts predict(const MatrixXd& calibration) const override {
    Forecasts forecasts{.bias = MatrixXd(sigma_.rows(), calibration.cols()),
                        .sigma = sigma_,
                        .own_sigma = {},
                        .nis = {}};
    for (Index run = 0; run < calibration.cols(); ++run) {
      P predictor{coefficients_};
      const double nis = calibrate(predictor, calibration.col(run));
      if (!std::isnan(nis)) forecasts.nis.push_back(nis);
      for (Index lead = 0; lead < sigma_.rows(); ++lead) {
        forecasts.bias(lead, run) =
            static_cast<double>(predictor.bias_rad_s(leads_[static_cast<std::size_t>(lead)]));
      }
    }
    return forecasts;
  }

 private:
  /// The mean of the normalised innovations; not a number for predictors that state none.
  double calibrate(P& predictor, const Eigen::VectorXd& samples) const {
    double sum = 0.0;
    int count = 0;
    predictor.begin_stop();
    for (const double sample : samples) {
      const core::Innovation innovation =
          predictor.step(tick_, static_cast<float>(sample), node_.white_variance_rad2_s2);
      if (innovation.first || !(innovation.variance_rad2_s2 > 0.0F)) continue;
      sum += static_cast<double>(innovation.normalised_squared());
      ++count;
    }
    return sum / count;
  }

  /// The intervals do not depend on the data: any calibration gives them.
  void state_sigmas(const Lengths& lengths) {
    P predictor{coefficients_};
    calibrate(predictor, Eigen::VectorXd::Zero(static_cast<Index>(lengths.calibration)));
    sigma_.resize(static_cast<Index>(lengths.prediction), 1);
    for (Index lead = 0; lead < sigma_.rows(); ++lead) {
      sigma_(lead) = static_cast<double>(predictor.predict(leads_[static_cast<std::size_t>(lead)])
                                             .of_raw_sample(node_.white_variance_rad2_s2)
                                             .sigma_rad_s());
    }
  }

  Node node_;
  typename P::Coefficients coefficients_{node_.modes};
  Span tick_;
  std::vector<Span> leads_;
  MatrixXd sigma_;
};

}  // namespace

std::unique_ptr<Predictor> make_decade_kalman(std::string name, const DecadeNoise& noise,
                                              const Lengths& lengths) {
  return std::make_unique<
      OnNode<core::KalmanPredictor<core::ModelShape{.decaying = kMostDecades}>>>(
      std::move(name), make_node(noise), lengths);
}

std::unique_ptr<Predictor> make_moving_average(std::string name, const DecadeNoise& noise,
                                               const Lengths& lengths) {
  return std::make_unique<OnNode<core::MovingAverage<core::ModelShape{.decaying = kMostDecades}>>>(
      std::move(name), make_node(noise), lengths);
}

std::unique_ptr<Predictor> make_calibration_mean(std::string name, const DecadeNoise& noise,
                                                 const Lengths& lengths) {
  return std::make_unique<
      OnNode<core::CalibrationMean<core::ModelShape{.decaying = kMostDecades}>>>(
      std::move(name), make_node(noise), lengths);
}

}  // namespace zerorate::paper
