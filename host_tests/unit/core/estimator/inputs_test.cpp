// Slope and curvature in the filter, against unknown constants that a measurement sees by the
// temperature of its tick.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "core/estimator/kalman_bank.hpp"
#include "core/estimator/kalman_predictor.hpp"
#include "core/noise/inputs.hpp"
#include "core/noise/terms.hpp"

namespace zerorate::core {
namespace {

constexpr Duration kTick = Duration::milliseconds(500);
constexpr double kTickS = 0.5;
constexpr std::size_t kLags = 3;
constexpr FlickerDecades<kLags> kFlicker{.time_constant_s = {0.5F, 5.0F, 50.0F},
                                         .variance_rad2_s2 = {1.0F, 1.0F, 1.0F}};
constexpr TemperatureDrift kDrift{.reference_degc = 30.0F,
                                  .slope_rad_s_per_k = 2.0F,
                                  .slope_sigma_rad_s_per_k = 4.0F,
                                  .curvature_rad_s_per_k2 = -0.1F,
                                  .curvature_sigma_rad_s_per_k2 = 0.3F};
constexpr double kWhiteVariance = 4.0;
constexpr InputTerms<2> kTerms = kDrift.terms();
constexpr ModelShape kShape{.decaying = kLags, .inputs = 2};
using Filter = KalmanPredictor<kShape>;
using Weights = InputTransition<2>::Weights;

/// Above the reference: a warm-up, and the sun now and then.
double excess_k(int tick) {
  const double t = tick * kTickS;
  return 12.0 - 20.0 * std::exp(-t / 900.0) + 3.0 * std::sin(t / 200.0);
}
Weights weights_at(int tick) {
  const auto e = static_cast<float>(excess_k(tick));
  return {e, e * e};
}

/// States: level, the lags, slope, curvature, and the sum of the bias over a drive.
class TimeVaryingFilter {
 public:
  TimeVaryingFilter() {
    p_(0, 0) = 1e9;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const auto lag = static_cast<std::size_t>(i);
      phi_(i + 1) = std::exp(-kTickS / double{kFlicker.time_constant_s[lag]});
      p_(i + 1, i + 1) = 1.0;
    }
    x_(4) = double{kDrift.slope_rad_s_per_k};
    x_(5) = double{kDrift.curvature_rad_s_per_k2};
    p_(4, 4) = std::pow(double{kDrift.slope_sigma_rad_s_per_k}, 2);
    p_(5, 5) = std::pow(double{kDrift.curvature_sigma_rad_s_per_k2}, 2);
  }
  void advance() {
    ++tick_;
    Matrix f = phi_.asDiagonal();
    x_ = f * x_;
    p_ = (f * p_ * f.transpose()).eval();
    for (Eigen::Index i = 1; i <= 3; ++i) p_(i, i) += 1.0 - phi_(i) * phi_(i);
    // Then the sum takes up the bias as it is now.
    Matrix g = Matrix::Identity();
    g.row(6) += seen().transpose();
    x_ = g * x_;
    p_ = (g * p_ * g.transpose()).eval();
  }
  void observe(double y) {
    const Vector h = seen();
    const Vector gain = p_ * h / (h.dot(p_ * h) + kWhiteVariance);
    x_ += gain * (y - h.dot(x_));
    const Matrix keep = Matrix::Identity() - gain * h.transpose();
    p_ = (keep * p_ * keep.transpose() + kWhiteVariance * gain * gain.transpose()).eval();
  }
  void begin_drive() {
    x_(6) = 0.0;
    p_.row(6).setZero();
    p_.col(6).setZero();
  }
  [[nodiscard]] double bias() const { return seen().dot(x_); }
  [[nodiscard]] double sigma() const { return std::sqrt(seen().dot(p_ * seen())); }
  [[nodiscard]] double angle() const { return x_(6) * kTickS; }
  [[nodiscard]] double angle_sigma() const { return std::sqrt(p_(6, 6)) * kTickS; }

 private:
  using Vector = Eigen::Matrix<double, 7, 1>;
  using Matrix = Eigen::Matrix<double, 7, 7>;
  [[nodiscard]] Vector seen() const {
    const double e = excess_k(tick_);
    return Vector{1.0, 1.0, 1.0, 1.0, e, e * e, 0.0};
  }
  int tick_ = 0;
  Vector phi_ = Vector::Ones();
  Vector x_ = Vector::Zero();
  Matrix p_ = Matrix::Zero();
};

/// Transition of the weights from one tick to a later one, tick by tick.
Filter::Transition span_over(const Modes<kLags, 0>& modes, int from, int to) {
  Filter::Transition span{modes.over(static_cast<std::uint32_t>(to - from))};
  for (std::size_t i = 0; i < 2; ++i) {
    for (int tick = from + 1; tick <= to; ++tick) {
      span.inputs.change[i] = weights_at(tick)[i] - weights_at(from)[i];
      span.inputs.sum[i] += span.inputs.change[i];
    }
  }
  return span;
}

TEST(KalmanPredictorWithTemperature, EqualsAFilterOfConstants) {
  const auto modes = compose(kTick, Start::stationary, kFlicker);
  const KalmanCoefficients<kShape> coefficients{modes, {}, kTerms};
  Filter filter{coefficients};
  TimeVaryingFilter oracle;
  std::mt19937_64 random{5};
  std::normal_distribution<double> noise{0.0, std::sqrt(kWhiteVariance + 3.0)};
  int measured = 0;
  int driving_since = 0;
  for (int k = 1; k <= 20'000; ++k) {
    const double e = excess_k(k);
    const auto y = static_cast<float>(100.0 + 5.0 * e + 0.15 * e * e + noise(random));
    if (k % 300 == 100) oracle.begin_drive(), driving_since = k - 1;
    oracle.advance();
    if (k % 300 < 100) {  // stops of 50 s, drives of 100 s
      filter.step(span_over(modes, measured, k), y, static_cast<float>(kWhiteVariance));
      oracle.observe(double{y});
      measured = k;
    } else if (k % 300 == 299 && k > 300) {
      const HeadingPrediction heading = filter.predict_heading(Filter::Transition{modes.over(0)},
                                                               span_over(modes, driving_since, k));
      ASSERT_EQ(driving_since, measured);
      EXPECT_NEAR(double{heading.angle_rad}, oracle.angle(), 2e-3 * oracle.angle_sigma()) << k;
      EXPECT_NEAR(double{heading.sigma_rad()} / oracle.angle_sigma(), 1.0, 1e-3) << k;
    }
    if (k < 10 || k % 7 != 0) continue;
    const Prediction prediction = filter.predict(span_over(modes, measured, k));
    EXPECT_NEAR(double{prediction.bias_rad_s}, oracle.bias(), 2e-3 * oracle.sigma()) << k;
    EXPECT_NEAR(double{prediction.sigma_rad_s()} / oracle.sigma(), 1.0, 1e-3) << k;
  }
  // It has learnt what the sensor does: within four of its own standard deviations, far below those
  // that it began with.
  for (const auto& [at, truth, prior] : {std::tuple{0U, 5.0, 4.0}, std::tuple{1U, 0.15, 0.3}}) {
    const std::size_t i = Filter::Coefficients::kFirstInput + at;
    const double sigma = std::sqrt(double{filter.state().filters[0].covariance(i, i)});
    EXPECT_NEAR(double{filter.state().filters[0].axes[0].drift[i]}, truth, 4.0 * sigma);
    EXPECT_LT(sigma, 0.2 * prior);
  }
}

TEST(KalmanPredictorWhoseTemperatureDoesNotChange, HasSameBits) {
  const auto modes = compose(kTick, Start::stationary, kFlicker);
  const KalmanCoefficients<kShape> with{modes, {}, kTerms};
  const KalmanCoefficients<ModelShape{.decaying = kLags}> without{modes};
  Filter followed{with};
  KalmanPredictor<ModelShape{.decaying = kLags}> plain{without};
  std::mt19937_64 random{6};
  std::normal_distribution<float> noise;
  for (int k = 0; k < 500; ++k) {
    const float y = noise(random);
    followed.step(Filter::Transition{modes.one_tick()}, y, 4.0F);
    plain.step(modes.one_tick(), y, 4.0F);
  }
  const Prediction a = followed.predict(Filter::Transition{modes.over(40)});
  const Prediction b = plain.predict(modes.over(40));
  EXPECT_EQ(a.bias_rad_s, b.bias_rad_s);
  EXPECT_EQ(a.variance_rad2_s2, b.variance_rad2_s2);
}

TEST(KalmanPredictorWhoseTemperatureIsUnknown, AddsItsVariance) {
  const auto modes = compose(kTick, Start::stationary, kFlicker);
  const KalmanCoefficients<kShape> coefficients{modes, {}, kTerms};
  Filter filter{coefficients};
  filter.step(Filter::Transition{modes.one_tick()}, 1.0F, 4.0F);
  Filter::Transition lead{modes.over(8)};
  const float known = filter.predict(lead).variance_rad2_s2;
  // 3 K at e = 5 K, not known: (slope + 2 e curvature) 3 K, which is 1 +- sqrt(16 + 100 0.09).
  lead.inputs.unknown = {3.0F, 30.0F};
  const float unknown = filter.predict(lead).variance_rad2_s2;
  EXPECT_NEAR(unknown - known, 9.0F * (1.0F + 25.0F), 1e-2F);
  const Filter::Transition none{modes.over(0)};
  Filter::Transition drive = lead;
  const float wide = filter.predict_heading(none, drive).variance_rad2;
  drive.inputs.unknown = {};
  const float narrow = filter.predict_heading(none, drive).variance_rad2;
  EXPECT_NEAR((wide - narrow) / (16.0F * 9.0F * 26.0F), 1.0F, 1e-4F);  // (8 ticks of 0.5 s)^2
  filter.advance(lead);
  EXPECT_FLOAT_EQ(filter.state().filters[0].bias_variance, unknown);
}

TEST(KalmanPredictorWithCoefficientsByAxis, BeginsFromEachAxis) {
  const auto modes = compose(kTick, Start::stationary, kFlicker);
  InputTerms<2> terms;
  terms.terms[0] = {Input::acceleration_x, 0.0F, {0.1F, -0.2F, 0.3F}};
  constexpr ModelShape kMoving{.decaying = kLags, .inputs = 2, .has_accelerometer = true};
  const KalmanCoefficients<kMoving> coefficients{modes, {}, terms};
  KalmanBank<kMoving, 3> bank{coefficients};
  (void)bank.observe({1.0F, 1.0F, 1.0F}, 4.0F);
  KalmanBank<kMoving, 3>::Transition lead{modes.over(8)};
  const auto before = bank.predict(lead);
  lead.inputs.change[0] = 0.5F;
  const auto leaning = bank.predict(lead);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(leaning[i].bias_rad_s - before[i].bias_rad_s, 0.5F * terms.terms[0].coefficient[i],
                1e-6F);
  }
}

TEST(KalmanPredictorWhoseForcesAreUnknown, AddsThemIndependently) {
  const auto modes = compose(kTick, Start::stationary, kFlicker);
  InputTerms<2> terms;
  terms.terms[0] = {Input::acceleration_x, 2.0F, {}};
  terms.terms[1] = {Input::acceleration_y, 2.0F, {}};
  constexpr ModelShape kMoving{.decaying = kLags, .inputs = 2, .has_accelerometer = true};
  const KalmanCoefficients<kMoving> coefficients{modes, {}, terms};
  KalmanPredictor<kMoving> filter{coefficients};
  filter.step(KalmanPredictor<kMoving>::Transition{modes.one_tick()}, 1.0F, 4.0F);
  KalmanPredictor<kMoving>::Transition lead{modes.over(8)};
  const float known = filter.predict(lead).variance_rad2_s2;
  lead.inputs.unknown = {0.5F, 1.0F};
  EXPECT_NEAR(filter.predict(lead).variance_rad2_s2 - known, 4.0F * (0.25F + 1.0F), 1e-3F);
}

}  // namespace
}  // namespace zerorate::core
