#include "host_tools/lab/paper/predictors.hpp"

#include "host_tools/lab/reference/autoregression.hpp"

namespace zerorate::paper {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using reference::FractionalNoise;

namespace {

class Weighted : public Predictor {
 public:
  Weighted(std::string name, MatrixXd weights, MatrixXd sigma, MatrixXd own_sigma)
      : Predictor(std::move(name), true),
        weights_(std::move(weights)),
        sigma_(std::move(sigma)),
        own_sigma_(std::move(own_sigma)) {}

  [[nodiscard]] Forecasts predict(const MatrixXd& calibration) const override {
    return {.bias = weights_ * calibration, .sigma = sigma_, .own_sigma = own_sigma_, .nis = {}};
  }

 private:
  MatrixXd weights_;
  MatrixXd sigma_;
  MatrixXd own_sigma_;
};

MatrixXd raw_sigma(const VectorXd& bias_variance, const FractionalNoise& noise) {
  return (bias_variance.array() + noise.white_variance).sqrt();
}

/// The error variance of predictors that weigh all samples alike and the newest ones each by
/// itself, a = (1 - s) / n 1 + (0, A) with s the sum of A: that of error_variance(), with what does
/// not depend on A summed in advance.
class MeanAndNewest {
 public:
  MeanAndNewest(const FractionalNoise& noise, const Lengths& lengths, std::size_t newest)
      : samples_(static_cast<Index>(lengths.calibration)) {
    const auto leads = static_cast<Index>(lengths.prediction);
    const auto p = static_cast<Index>(newest);
    MatrixXd c = reference::covariance(noise, lengths.total());
    c.diagonal().head(samples_).array() += noise.white_variance;
    const VectorXd sums = c.topLeftCorner(samples_, samples_).rowwise().sum();
    total_ = sums.sum();
    sums_ = sums.tail(p);
    newest_ = c.block(samples_ - p, samples_ - p, p, p);
    cross_sums_ = c.bottomLeftCorner(leads, samples_).rowwise().sum();
    cross_ = c.block(samples_, samples_ - p, leads, p);
    prior_ = c.diagonal().tail(leads);
  }

  /// @param weights A, leads x newest samples
  [[nodiscard]] VectorXd error_variance(const MatrixXd& weights) const {
    const VectorXd mean = (1.0 - weights.rowwise().sum().array()) / static_cast<double>(samples_);
    const VectorXd of_newest =
        (weights * newest_ - 2.0 * cross_).cwiseProduct(weights).rowwise().sum();
    return prior_ + of_newest +
           mean.cwiseProduct(mean * total_ + 2.0 * (weights * sums_) - 2.0 * cross_sums_);
  }

 private:
  Index samples_;
  double total_ = 0.0;
  VectorXd sums_;
  MatrixXd newest_;
  VectorXd cross_sums_;
  MatrixXd cross_;
  VectorXd prior_;
};

class Autoregressive : public Predictor {
 public:
  Autoregressive(std::string name, AutoregressionFit fit, std::size_t order,
                 const FractionalNoise& noise, const Lengths& lengths)
      : Predictor(std::move(name), false),
        fit_(fit),
        order_(order),
        leads_(lengths.prediction),
        noise_(noise),
        errors_(noise, lengths, order) {}

  [[nodiscard]] Forecasts predict(const MatrixXd& calibration) const override {
    const MatrixXd empty(static_cast<Index>(leads_), calibration.cols());
    Forecasts forecasts{.bias = empty, .sigma = empty, .own_sigma = empty, .nis = {}};
    for (Index run = 0; run < calibration.cols(); ++run) {
      const std::span data{calibration.col(run).data(),
                           static_cast<std::size_t>(calibration.rows())};
      const reference::Autoregression model = fit_ == AutoregressionFit::burg
                                                  ? reference::fit_burg(data, order_)
                                                  : reference::fit_least_squares(data, order_);
      const reference::Forecast ahead = reference::forecast(model, data, leads_);
      forecasts.bias.col(run) = ahead.values;
      forecasts.own_sigma.col(run) = ahead.variance.cwiseSqrt();
      forecasts.sigma.col(run) =
          raw_sigma(errors_.error_variance(reference::forecast_weights(model, leads_)), noise_);
    }
    return forecasts;
  }

 private:
  AutoregressionFit fit_;
  std::size_t order_;
  std::size_t leads_;
  FractionalNoise noise_;
  MeanAndNewest errors_;
};

}  // namespace

std::unique_ptr<Predictor> make_full_state(std::string name, const FractionalNoise& noise,
                                           const Lengths& lengths) {
  auto predictor =
      reference::make_plug_in_predictor(noise, lengths.calibration, lengths.prediction);
  MatrixXd sigma = raw_sigma(reference::error_variance(noise, predictor.weights), noise);
  return std::make_unique<Weighted>(std::move(name), std::move(predictor.weights), std::move(sigma),
                                    raw_sigma(predictor.variance, noise));
}

std::unique_ptr<Predictor> make_optimum(std::string name, const FractionalNoise& noise,
                                        reference::Bias bias, const Lengths& lengths) {
  auto predictor =
      reference::make_best_linear_predictor(noise, bias, lengths.calibration, lengths.prediction);
  return std::make_unique<Weighted>(std::move(name), std::move(predictor.weights),
                                    raw_sigma(predictor.variance, noise), MatrixXd{});
}

std::unique_ptr<Predictor> make_autoregression(std::string name, AutoregressionFit fit,
                                               std::size_t order, const FractionalNoise& noise,
                                               const Lengths& lengths) {
  return std::make_unique<Autoregressive>(std::move(name), fit, order, noise, lengths);
}

}  // namespace zerorate::paper
