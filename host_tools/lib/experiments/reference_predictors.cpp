#include "host_tools/lib/experiments/reference_predictors.hpp"

#include "host_tools/lib/reference/autoregression.hpp"
#include "host_tools/lib/reference/plug_in_predictor.hpp"

namespace zerorate::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using reference::LinearPredictor;

class Weighted : public Predictor {
 public:
  Weighted(std::string name, LinearPredictor predictor, double white_variance)
      : Predictor(std::move(name), true),
        weights_(std::move(predictor.weights)),
        sigma_((predictor.variance.array() + white_variance).sqrt()) {}

  [[nodiscard]] Forecasts predict(const MatrixXd& calibration) const override {
    return {.bias = weights_ * calibration, .sigma = sigma_, .nis = {}};
  }

 private:
  MatrixXd weights_;
  MatrixXd sigma_;
};

class Autoregressive : public Predictor {
 public:
  Autoregressive(std::string name, AutoregressionFit fit, std::size_t order, std::size_t leads)
      : Predictor(std::move(name), false), fit_(fit), order_(order), leads_(leads) {}

  [[nodiscard]] Forecasts predict(const MatrixXd& calibration) const override {
    const auto leads = static_cast<Index>(leads_);
    Forecasts forecasts{.bias = MatrixXd(leads, calibration.cols()),
                        .sigma = MatrixXd(leads, calibration.cols()),
                        .nis = {}};
    for (Index run = 0; run < calibration.cols(); ++run) {
      const std::span data{calibration.col(run).data(),
                           static_cast<std::size_t>(calibration.rows())};
      const reference::Autoregression model = fit_ == AutoregressionFit::burg
                                                  ? reference::fit_burg(data, order_)
                                                  : reference::fit_least_squares(data, order_);
      const reference::Forecast ahead = reference::forecast(model, data, leads_);
      forecasts.bias.col(run) = ahead.values;
      forecasts.sigma.col(run) = ahead.variance.cwiseSqrt();
    }
    return forecasts;
  }

 private:
  AutoregressionFit fit_;
  std::size_t order_;
  std::size_t leads_;
};

}  // namespace

std::unique_ptr<Predictor> make_full_state(std::string name,
                                           const reference::FractionalNoise& noise,
                                           const Lengths& lengths) {
  return std::make_unique<Weighted>(
      std::move(name),
      reference::make_plug_in_predictor(noise, lengths.calibration, lengths.prediction),
      noise.white_variance);
}

std::unique_ptr<Predictor> make_optimum(std::string name, const reference::FractionalNoise& noise,
                                        reference::Bias bias, const Lengths& lengths) {
  return std::make_unique<Weighted>(
      std::move(name),
      reference::make_best_linear_predictor(noise, bias, lengths.calibration, lengths.prediction),
      noise.white_variance);
}

std::unique_ptr<Predictor> make_autoregression(std::string name, AutoregressionFit fit,
                                               std::size_t order, const Lengths& lengths) {
  return std::make_unique<Autoregressive>(std::move(name), fit, order, lengths.prediction);
}

}  // namespace zerorate::experiments
