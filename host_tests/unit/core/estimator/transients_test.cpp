// Warm-up and ramp in the filter, against unknown constants that a measurement sees by a factor
// that changes with time.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "core/estimator/calibration_mean.hpp"
#include "core/estimator/kalman_predictor.hpp"
#include "core/noise/terms.hpp"

namespace zerorate::core {
namespace {

constexpr Duration kTick = Duration::milliseconds(100);
constexpr double kTickS = 0.1;
constexpr FlickerDecades<3> kFlicker{.time_constant_s = {0.1F, 1.0F, 10.0F},
                                     .variance_rad2_s2 = {1.0F, 1.0F, 1.0F}};
constexpr WarmUp kWarmUp{.amplitude_rad_s = 30.0F, .sigma_rad_s = 10.0F, .time_constant_s = 40.0F};
constexpr RateRamp kRamp{.slope_rad_s2 = 0.05F, .sigma_rad_s2 = 0.1F};
constexpr double kWhiteVariance = 2.0;

/// States: level, three lags, amplitude of the warm-up, slope; the last two and the level constant.
class TimeVaryingFilter {
 public:
  TimeVaryingFilter() {
    p_(0, 0) = 1e10;
    for (Eigen::Index i = 0; i < 3; ++i) {
      phi_(i + 1) =
          std::exp(-kTickS / double{kFlicker.time_constant_s[static_cast<std::size_t>(i)]});
      p_(i + 1, i + 1) = 1.0;
    }
    x_(4) = double{kWarmUp.amplitude_rad_s};
    p_(4, 4) = std::pow(double{kWarmUp.sigma_rad_s}, 2);
    x_(5) = double{kRamp.slope_rad_s2};
    p_(5, 5) = std::pow(double{kRamp.sigma_rad_s2}, 2);
  }
  void advance() {
    ++ticks_;
    x_ = phi_.cwiseProduct(x_);
    p_ = (phi_ * phi_.transpose()).cwiseProduct(p_);
    for (Eigen::Index i = 1; i <= 3; ++i) p_(i, i) += 1.0 - phi_(i) * phi_(i);
  }
  void observe(double y) {
    const Vector h = seen();
    const Vector gain = p_ * h / (h.dot(p_ * h) + kWhiteVariance);
    x_ += gain * (y - h.dot(x_));
    const Matrix keep = Matrix::Identity() - gain * h.transpose();
    p_ = (keep * p_ * keep.transpose() + kWhiteVariance * gain * gain.transpose()).eval();
  }
  /// The power goes off and on: another amplitude and another slope, and time begins anew. What the
  /// slope has put on the bias is the level's from now on.
  void restart() {
    Matrix to_new = Matrix::Identity();
    to_new(0, 5) = ticks_ * kTickS;
    to_new(4, 4) = to_new(5, 5) = 0.0;
    x_ = to_new * x_;
    p_ = (to_new * p_ * to_new.transpose()).eval();
    x_(4) = double{kWarmUp.amplitude_rad_s};
    p_(4, 4) = std::pow(double{kWarmUp.sigma_rad_s}, 2);
    x_(5) = double{kRamp.slope_rad_s2};
    p_(5, 5) = std::pow(double{kRamp.sigma_rad_s2}, 2);
    ticks_ = 0.0;
  }
  [[nodiscard]] double bias() const { return seen().dot(x_); }
  [[nodiscard]] double sigma() const { return std::sqrt(seen().dot(p_ * seen())); }

 private:
  using Vector = Eigen::Matrix<double, 6, 1>;
  using Matrix = Eigen::Matrix<double, 6, 6>;
  [[nodiscard]] Vector seen() const {
    Vector h = Vector::Ones();
    h(4) = std::exp(-ticks_ * kTickS / double{kWarmUp.time_constant_s});
    h(5) = ticks_ * kTickS;
    return h;
  }
  double ticks_ = 0.0;
  Vector phi_ = Vector::Ones();
  Vector x_ = Vector::Zero();
  Matrix p_ = Matrix::Zero();
};

TEST(KalmanPredictorWithWarmUpAndRamp, EqualsADenseFilter) {
  const auto modes = compose(kTick, Start::stationary, kFlicker, kWarmUp, kRamp);
  const KalmanCoefficients coefficients{modes};
  KalmanPredictor filter{coefficients};
  TimeVaryingFilter oracle;
  std::mt19937_64 random{5};
  std::normal_distribution<double> noise{0.0, std::sqrt(kWhiteVariance + 3.0)};
  std::uint32_t missed = 0;
  for (int k = 1; k <= 5000; ++k) {
    const double t = k * kTickS;
    const auto y =
        static_cast<float>(100.0 + 24.0 * std::exp(-t / 40.0) - 0.03 * t + noise(random));
    oracle.advance();
    ++missed;
    if (k % 500 < 150) {  // stops of 15 s, drives of 35 s
      filter.step(modes.over(missed), y, static_cast<float>(kWhiteVariance));
      oracle.observe(double{y});
      missed = 0;
    }
    if (k < 10 || k % 7 != 0) continue;
    const Prediction prediction = filter.predict(modes.over(missed));
    ASSERT_NEAR(double{prediction.sigma_rad_s()} / oracle.sigma(), 1.0, 2e-4) << k;
    ASSERT_NEAR(double{prediction.bias_rad_s}, oracle.bias(), 2e-3 * oracle.sigma()) << k;
  }
}

TEST(KalmanPredictorWithWarmUpAndRamp, LetsThemBeginAnew) {
  const auto modes = compose(kTick, Start::stationary, kFlicker, kWarmUp, kRamp);
  const KalmanCoefficients coefficients{modes};
  KalmanPredictor filter{coefficients};
  TimeVaryingFilter oracle;
  std::mt19937_64 random{6};
  std::normal_distribution<double> noise{0.0, std::sqrt(kWhiteVariance + 3.0)};
  const auto measure = [&](int ticks, double level, double amplitude, double slope) {
    for (int k = 1; k <= ticks; ++k) {
      const double t = k * kTickS;
      const auto y =
          static_cast<float>(level + amplitude * std::exp(-t / 40.0) + slope * t + noise(random));
      oracle.advance();
      oracle.observe(double{y});
      filter.step(modes.one_tick(), y, static_cast<float>(kWhiteVariance));
    }
  };
  for (const int ticks : {30, 300, 2000}) {
    measure(ticks, 100.0, 24.0, -0.03);
    filter.restart_transients();
    oracle.restart();
    const Prediction prediction = filter.predict(modes.over(0));
    EXPECT_NEAR(double{prediction.sigma_rad_s()} / oracle.sigma(), 1.0, 1e-3) << ticks;
    EXPECT_NEAR(double{prediction.bias_rad_s}, oracle.bias(), 2e-3 * oracle.sigma()) << ticks;
    measure(200, 97.0, 35.0, 0.1);
    const Prediction later = filter.predict(modes.over(0));
    EXPECT_NEAR(double{later.sigma_rad_s()} / oracle.sigma(), 1.0, 1e-3) << ticks;
    EXPECT_NEAR(double{later.bias_rad_s}, oracle.bias(), 1e-2 * oracle.sigma()) << ticks;
  }
}

TEST(CalibrationMeanDuringAWarmUp, KnowsThatItIsOff) {
  const auto calm = compose(kTick, Start::stationary, kFlicker);
  const auto warming = compose(kTick, Start::stationary, kFlicker, kWarmUp);
  CalibrationMean without{calm};
  CalibrationMean with{warming};
  for (int k = 0; k < 100; ++k) {
    without.step(calm.one_tick(), 0.0F, 2.0F);
    with.step(warming.one_tick(), 0.0F, 2.0F);
  }
  // From 5 s, the middle of the mean, to 50 s the transient of 30 +- 10 falls by its e^-0.125 -
  // e^-1.25.
  const double fall = std::exp(-0.125) - std::exp(-1.25);
  const double expected = (30.0 * 30.0 + 10.0 * 10.0) * fall * fall;
  const float more = with.predict(warming.over(400)).variance_rad2_s2 -
                     without.predict(calm.over(400)).variance_rad2_s2;
  EXPECT_NEAR(double{more} / expected, 1.0, 0.01);
}

TEST(WarmUpThatIsLongOver, LeavesNoDenormalNumbers) {
  const auto modes = compose(kTick, Start::stationary, kFlicker, WarmUp{.sigma_rad_s = 1e-3F});
  const KalmanCoefficients coefficients{modes};
  KalmanPredictor filter{coefficients};
  for (int k = 0; k < 20'000; ++k) filter.step(modes.one_tick(), 0.0F, 2.0F);
  EXPECT_TRUE(std::isnormal(filter.state().filters[0].covariance(3, 3)));
}

}  // namespace
}  // namespace zerorate::core
