#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "host_tools/lab/reference/autoregression.hpp"
#include "host_tools/lab/reference/fractional_noise.hpp"
#include "host_tools/lab/reference/full_state_filter.hpp"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::reference {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kSamples = 120;
constexpr std::size_t kLeads = 80;

constexpr FractionalNoise kPaper{.order = 0.5, .innovation_variance = 6.25};
constexpr FractionalNoise kWithWhite{
    .order = 0.7, .innovation_variance = 2.0, .white_variance = 5.0};

// Any numbers do: the predictors are linear, and their agreement is an identity.
VectorXd any_data() {
  VectorXd data(kSamples);
  random::RandomStream{3}.fill_normal(0, {data.data(), kSamples});
  return data.array() + 17.0;
}

struct Forecast {
  VectorXd values{kLeads};
  VectorXd variance{kLeads};
};

// Sample by sample, as the paper writes it.
Forecast by_recursion(const FractionalNoise& noise, const VectorXd& data,
                      const FullStateFilter::Mean& mean) {
  FullStateFilter filter{noise, mean, kSamples + kLeads};
  for (const double value : data) {
    filter.advance();
    filter.observe(value);
  }
  Forecast forecast;
  for (std::size_t j = 0; j < kLeads; ++j) {
    filter.advance();
    forecast.values(static_cast<Eigen::Index>(j)) = filter.bias();
    forecast.variance(static_cast<Eigen::Index>(j)) = filter.bias_variance();
  }
  return forecast;
}

void expect_equal(const LinearPredictor& predictor, const VectorXd& data, const Forecast& expected,
                  double tolerance) {
  EXPECT_LT((predictor.weights * data - expected.values).cwiseAbs().maxCoeff(), tolerance);
  EXPECT_LT((predictor.variance - expected.variance).cwiseAbs().maxCoeff(), tolerance);
}

TEST(FullStateFilter, WeighsThePastByEquationSix) {
  // x_1 .. x_3 are observed without noise; x_4 is then predicted by eq. 6 alone.
  const double d = 0.5;
  FullStateFilter filter{kPaper, {}, 4};
  for (const double x : {1.0, -2.0, 5.0}) {
    filter.advance();
    filter.observe(x);
  }
  filter.advance();
  const auto f = [d](double lag) {
    return -std::tgamma(lag - d) / (std::tgamma(lag + 1.0) * std::tgamma(-d));
  };
  EXPECT_NEAR(filter.bias(), f(3) * 1.0 + f(2) * -2.0 + f(1) * 5.0, 1e-12);
  EXPECT_NEAR(filter.innovation_variance(), kPaper.innovation_variance, 1e-12);
}

TEST(FullStateFilter, RefusesToGrowBeyondItsCapacity) {
  FullStateFilter filter{kPaper, {}, 1};
  filter.advance();
  EXPECT_THROW(filter.advance(), std::length_error);
}

TEST(FullStateFilter, AfterWaitingEqualsTheOneThatWaited) {
  FullStateFilter waited{kWithWhite, {}, 30};
  for (int k = 0; k < 20; ++k) waited.advance();
  FullStateFilter jumped = FullStateFilter::after_waiting(kWithWhite, 20, 30);
  for (FullStateFilter* filter : {&waited, &jumped}) {
    filter->advance();
    filter->observe(3.0);
    filter->advance();
  }
  EXPECT_NEAR(jumped.bias(), waited.bias(), 1e-10);
  EXPECT_NEAR(jumped.bias_variance(), waited.bias_variance(), 1e-10);
}

TEST(PlugInPredictor, EqualsTheRecursionOfThePaper) {
  const VectorXd data = any_data();
  for (const FractionalNoise& noise : {kPaper, kWithWhite}) {
    expect_equal(make_plug_in_predictor(noise, kSamples, kLeads), data,
                 by_recursion(noise, data, {.value = data.mean()}), 1e-9);
  }
}

TEST(PlugInPredictor, StatesLessThanItsError) {
  const LinearPredictor predictor = make_plug_in_predictor(kPaper, kSamples, kLeads);
  const VectorXd truth = error_variance(kPaper, predictor.weights);
  EXPECT_GT(truth(kLeads - 1), 1.04 * predictor.variance(kLeads - 1));
}

TEST(BestLinearPredictor, EqualsTheRecursionWithAnUnknownMean) {
  const VectorXd data = any_data();
  const double nearly_unknown = 1e7;  // relative error about C / 1e7, rounding about 1e7 epsilon
  for (const FractionalNoise& noise : {kPaper, kWithWhite}) {
    expect_equal(make_best_linear_predictor(noise, Bias::diffuse, kSamples, kLeads), data,
                 by_recursion(noise, data, {.variance = nearly_unknown}), 2e-5);
  }
}

TEST(BestLinearPredictor, EqualsTheRecursionWithAGivenMean) {
  const VectorXd data = any_data();
  expect_equal(make_best_linear_predictor(kWithWhite, Bias::known, kSamples, kLeads), data,
               by_recursion(kWithWhite, data, {}), 1e-9);
}

TEST(BestLinearPredictor, StatesItsErrorAndFollowsAShift) {
  const LinearPredictor best =
      make_best_linear_predictor(kWithWhite, Bias::diffuse, kSamples, kLeads);
  EXPECT_LT((error_variance(kWithWhite, best.weights) - best.variance).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((best.weights.rowwise().sum().array() - 1.0).abs().maxCoeff(), 1e-10);
}

TEST(BestLinearPredictor, BeatsAnyOtherUnbiasedOneAtEveryLead) {
  const LinearPredictor best = make_best_linear_predictor(kPaper, Bias::diffuse, kSamples, kLeads);
  const LinearPredictor plug_in = make_plug_in_predictor(kPaper, kSamples, kLeads);
  const MatrixXd mean = MatrixXd::Constant(kLeads, kSamples, 1.0 / kSamples);
  for (const MatrixXd& other : {plug_in.weights, mean}) {
    const VectorXd excess = error_variance(kPaper, other) - best.variance;
    EXPECT_GT(excess.minCoeff(), -1e-10);
  }
}

TEST(Covariance, IsTheProductOfTheIntegrationMatrices) {
  const VectorXd psi = impulse_response(0.3, 50);
  MatrixXd integration = MatrixXd::Zero(50, 50);
  for (Eigen::Index j = 0; j < 50; ++j) {
    for (Eigen::Index i = j; i < 50; ++i) integration(i, j) = psi(i - j);
  }
  const MatrixXd expected = 4.0 * integration * integration.transpose();
  EXPECT_LT(
      (covariance({.order = 0.3, .innovation_variance = 4.0}, 50) - expected).cwiseAbs().maxCoeff(),
      1e-12);
}

TEST(ErrorCovariance, OfTheMeanOfWhiteNoiseIsTheClosedForm) {
  // Each of m values has r, and all share the mean of n values: r (1 + 1 1' / n).
  const MatrixXd mean = MatrixXd::Constant(30, 20, 1.0 / 20.0);
  const FractionalNoise white{.innovation_variance = 0.0, .white_variance = 3.0};
  const MatrixXd expected = 3.0 * (MatrixXd::Identity(30, 30) + MatrixXd::Ones(30, 30) / 20.0);
  EXPECT_LT((error_covariance(white, mean) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ErrorCovariance, HasTheErrorVarianceOfEachLeadOnItsDiagonal) {
  const LinearPredictor plug_in = make_plug_in_predictor(kWithWhite, kSamples, kLeads);
  const VectorXd expected =
      error_variance(kWithWhite, plug_in.weights).array() + kWithWhite.white_variance;
  const VectorXd diagonal = error_covariance(kWithWhite, plug_in.weights).diagonal();
  EXPECT_LT((diagonal - expected).cwiseAbs().maxCoeff(), 1e-10);
}

using Eigen::MatrixXd;

TEST(GaussianNorm, OfEqualVariancesIsThatOfTheChiDistribution) {
  for (const int n : {1, 2, 7, 300}) {
    const NormMoments norm = gaussian_norm(9.0 * MatrixXd::Identity(n, n));
    const double chi =
        std::numbers::sqrt2 * std::exp(std::lgamma(0.5 * (n + 1)) - std::lgamma(0.5 * n));
    EXPECT_NEAR(norm.mean / (3.0 * chi), 1.0, 1e-8) << n;
    EXPECT_NEAR(norm.standard_deviation, 3.0 * std::sqrt(n - chi * chi), 1e-5 * norm.mean) << n;
  }
}

// In two dimensions the mean is sqrt(2 a / pi) E(sqrt(1 - b / a)), a >= b, with the complete
// elliptic integral of the second kind; turning the axes changes nothing.
TEST(GaussianNorm, OfAnyEllipseIsAnEllipticIntegral) {
  const double a = 5.0;
  const double b = 0.02;
  MatrixXd turn(2, 2);
  turn << 0.6, -0.8, 0.8, 0.6;
  const MatrixXd covariance = turn * Eigen::Vector2d(a, b).asDiagonal() * turn.transpose();
  const double expected =
      std::sqrt(2.0 * a / std::numbers::pi) * std::comp_ellint_2(std::sqrt(1.0 - b / a));
  EXPECT_NEAR(gaussian_norm(covariance).mean, expected, 1e-8 * expected);
}

// Directions without any variance (and eigenvalues that rounding makes negative) do no harm.
TEST(GaussianNorm, OfADegenerateCovarianceIsThatOfItsRank) {
  const Eigen::VectorXd along = Eigen::VectorXd::LinSpaced(50, 1.0, 2.0);
  const NormMoments norm = gaussian_norm(along * along.transpose());
  EXPECT_NEAR(norm.mean, along.norm() * std::sqrt(2.0 / std::numbers::pi), 1e-8 * along.norm());
}

// y = 5 + 1.2 (y_1 - 5) - 0.5 (y_2 - 5) + 2 e: a damped oscillation.
std::vector<double> second_order(std::size_t n) {
  std::vector<double> noise(n);
  random::RandomStream{11}.fill_normal(0, noise);
  std::vector<double> y(n, 5.0);
  for (std::size_t k = 2; k < n; ++k) {
    y[k] = 5.0 + 1.2 * (y[k - 1] - 5.0) - 0.5 * (y[k - 2] - 5.0) + 2.0 * noise[k];
  }
  return y;
}

TEST(Autoregression, IsRecoveredByBothFits) {
  const std::size_t n = 20'000;
  const std::vector<double> y = second_order(n);
  // Standard error of each coefficient: sqrt((1 - 0.5^2) / n) (Box and Jenkins, section 7.2).
  const double tolerance = 4.0 * std::sqrt(0.75 / static_cast<double>(n));
  for (const Autoregression& fit : {fit_least_squares(y, 2), fit_burg(y, 2)}) {
    EXPECT_NEAR(fit.coefficients(0), 1.2, tolerance);
    EXPECT_NEAR(fit.coefficients(1), -0.5, tolerance);
    // Standard error of the variance: sqrt(2 / n) of it.
    EXPECT_NEAR(fit.innovation_variance, 4.0, 4.0 * 4.0 * std::sqrt(2.0 / static_cast<double>(n)));
    // The mean's: 2 / (1 - 1.2 + 0.5) / sqrt(n).
    EXPECT_NEAR(fit.mean, 5.0, 4.0 * 2.0 / 0.3 / std::sqrt(static_cast<double>(n)));
  }
}

TEST(Autoregression, FitsAgreeOnALongRecord) {
  const std::vector<double> y = second_order(20'000);
  const Autoregression one = fit_least_squares(y, 6);
  const Autoregression other = fit_burg(y, 6);
  // They differ by their treatment of the ends: by O(order / n).
  EXPECT_LT((one.coefficients - other.coefficients).cwiseAbs().maxCoeff(), 20.0 / 20'000);
}

TEST(AutoregressionForecast, IsTheIteratedRecursion) {
  const Autoregression model{
      .mean = 5.0, .coefficients = Eigen::Vector2d{1.2, -0.5}, .innovation_variance = 4.0};
  const std::vector<double> y{0.0, 7.0, 8.0};
  const auto ahead = forecast(model, y, 3);
  const double first = 5.0 + 1.2 * 3.0 - 0.5 * 2.0;
  const double second = 5.0 + 1.2 * (first - 5.0) - 0.5 * 3.0;
  EXPECT_DOUBLE_EQ(ahead.values(0), first);
  EXPECT_DOUBLE_EQ(ahead.values(1), second);
  EXPECT_DOUBLE_EQ(ahead.values(2), 5.0 + 1.2 * (second - 5.0) - 0.5 * (first - 5.0));
  const double psi2 = 1.2 * 1.2 - 0.5;
  EXPECT_DOUBLE_EQ(ahead.variance(2), 4.0 * (1.0 + 1.44 + psi2 * psi2));
}

TEST(AutoregressionForecast, IsItsWeightsTimesTheNewestValues) {
  const std::vector<double> y = second_order(1000);
  const Autoregression model = fit_burg(y, 30);
  const Eigen::Map<const Eigen::VectorXd> newest{y.data() + 970, 30};
  const Eigen::VectorXd weighed =
      (forecast_weights(model, 200) * (newest.array() - model.mean).matrix()).array() + model.mean;
  EXPECT_LT((weighed - forecast(model, y, 200).values).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(AutoregressionForecast, OfBurgsModelReturnsToTheMean) {
  const std::vector<double> y = second_order(1000);
  const Autoregression model = fit_burg(y, 120);
  EXPECT_NEAR(forecast(model, y, 5000).values(4999), model.mean, 1e-6);
}

TEST(Autoregression, RefusesTooFewValues) {
  const std::vector<double> y(8);
  EXPECT_THROW((void)fit_least_squares(y, 4), std::invalid_argument);
  EXPECT_THROW((void)fit_burg(y, 8), std::invalid_argument);
}

}  // namespace
}  // namespace zerorate::reference
