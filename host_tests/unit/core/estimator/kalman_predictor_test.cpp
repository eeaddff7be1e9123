#include "core/estimator/kalman_predictor.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "core/estimator/bias_predictor.hpp"
#include "host_tests/support/dense_noise.hpp"
#include "host_tests/support/sample_modes.hpp"

namespace zerorate::core {
namespace {

using testing::flicker_like;
using testing::mixed_modes;

static_assert(BiasPredictor<KalmanPredictor<ModelShape{.decaying = 6}>>);
static_assert(BiasPredictor<KalmanPredictor<ModelShape{.decaying = 5, .rotating = 1}>>);

/// The oracle: a textbook Kalman filter in double, states (b, z), dense matrices, Joseph's form,
/// h = ones; b starts with a huge variance.
class DenseFilter {
 public:
  template <std::size_t R, std::size_t C>
  explicit DenseFilter(const Modes<R, C>& modes) {
    const auto n = static_cast<Eigen::Index>(1 + R + 2 * C);
    f_ = Eigen::MatrixXd::Identity(n, n);
    q_ = Eigen::MatrixXd::Zero(n, n);
    p_ = Eigen::MatrixXd::Zero(n, n);
    h_ = Eigen::VectorXd::Zero(n);
    x_ = Eigen::VectorXd::Zero(n);
    p_(0, 0) = 1e12;
    q_(0, 0) = double{modes.walk_variance};
    h_(0) = 1.0;
    Eigen::Index i = 1;
    for (const auto& mode : modes.decaying) {
      f_(i, i) = 1.0 - double{mode.one_minus_phi};
      q_(i, i) = double{mode.noise_variance};
      p_(i, i) = double{mode.initial_variance};
      h_(i++) = 1.0;
    }
    for (const auto& mode : modes.rotating) {
      const double re = 1.0 - double{mode.one_minus_phi.re};
      const double im = -double{mode.one_minus_phi.im};
      f_.block<2, 2>(i, i) << re, -im, im, re;
      q_(i, i) = q_(i + 1, i + 1) = double{mode.noise_variance};
      p_(i, i) = p_(i + 1, i + 1) = double{mode.initial_variance};
      h_(i) = 1.0;
      i += 2;
    }
  }
  void predict() {
    x_ = f_ * x_;
    p_ = f_ * p_ * f_.transpose() + q_;
  }
  void update(double y, double r) {
    const Eigen::VectorXd k = p_ * h_ / (h_.dot(p_ * h_) + r);
    x_ += k * (y - h_.dot(x_));
    const Eigen::MatrixXd a = Eigen::MatrixXd::Identity(x_.size(), x_.size()) - k * h_.transpose();
    p_ = (a * p_ * a.transpose() + r * k * k.transpose()).eval();
  }
  [[nodiscard]] double bias() const { return h_.dot(x_); }
  [[nodiscard]] double sigma() const { return std::sqrt(h_.dot(p_ * h_)); }

 private:
  Eigen::MatrixXd f_, q_, p_;
  Eigen::VectorXd h_, x_;
};

/// Measurements of level + modes drawn from the model, in double.
template <std::size_t R, std::size_t C>
class SimulatedSensor {
 public:
  SimulatedSensor(const Modes<R, C>& modes, double level, double r, unsigned seed)
      : modes_(modes), level_(level), sqrt_r_(std::sqrt(r)), random_(seed) {
    for (std::size_t i = 0; i < R; ++i) {
      z_[i] = std::sqrt(double{modes.decaying[i].initial_variance}) * normal_(random_);
    }
  }
  float next() {
    level_ += std::sqrt(double{modes_.walk_variance}) * normal_(random_);
    double sum = level_;
    for (std::size_t i = 0; i < R; ++i) {
      const auto& mode = modes_.decaying[i];
      z_[i] = (1.0 - double{mode.one_minus_phi}) * z_[i] +
              std::sqrt(double{mode.noise_variance}) * normal_(random_);
      sum += z_[i];
    }
    for (std::size_t i = 0; i < C; ++i) {
      const auto& mode = modes_.rotating[i];
      const double s = std::sqrt(double{mode.noise_variance});
      const std::complex<double> factor{1.0 - double{mode.one_minus_phi.re},
                                        -double{mode.one_minus_phi.im}};
      u_[i] = factor * u_[i] + std::complex<double>{s * normal_(random_), s * normal_(random_)};
      sum += u_[i].real();
    }
    return static_cast<float>(sum + sqrt_r_ * normal_(random_));
  }

 private:
  Modes<R, C> modes_;
  double level_, sqrt_r_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::array<double, R> z_{};
  std::array<std::complex<double>, C> u_{};
};

struct Disagreement {
  double bias = 0.0;   ///< largest |difference| relative to the oracle's bias
  double sigma = 0.0;  ///< largest |ratio - 1|
};

/// Runs filter and oracle over stops and drives; the filter crosses each drive in one gap.
template <class ModesType>
Disagreement compare(const ModesType& modes, double level, double r, int stop, int drive,
                     int steps) {
  const KalmanCoefficients coefficients{modes};
  KalmanPredictor filter{coefficients};
  DenseFilter oracle{modes};
  SimulatedSensor sensor{modes, level, r, 7};
  Disagreement worst;
  const auto tick = modes.one_tick();
  std::uint32_t missed = 0;
  for (int k = 0; k < steps; ++k) {
    const float y = sensor.next();
    if (k > 0) oracle.predict(), ++missed;
    if (k % (stop + drive) < stop) {
      filter.step(missed == 1 ? tick : modes.over(missed), y, static_cast<float>(r));
      missed = 0;
      oracle.update(double{y}, double{static_cast<float>(r)});
    }
    if (missed % 16 != 0) continue;
    const Prediction prediction = filter.predict(modes.over(missed));
    worst.bias =
        std::max(worst.bias, std::abs(double{prediction.bias_rad_s} / oracle.bias() - 1.0));
    worst.sigma =
        std::max(worst.sigma, std::abs(double{prediction.sigma_rad_s()} / oracle.sigma() - 1.0));
  }
  return worst;
}

/// Verifies SR-PRED-02.
TEST(KalmanPredictorOverStopsAndDrives, EqualsADenseFilterTo1e5) {
  const Duration tick = Duration::seconds(1);
  // A bias of 100 flicker units: 0.3 deg/s over 10 deg/h, an ordinary sensor.
  for (const double order : {0.5, 0.62, 0.8}) {
    const auto modes = compose(tick, Start::stationary, flicker_like<6>(tick, order));
    const auto worst = compare(modes, 100.0, 10.0, 60, 300, 100'000);
    EXPECT_LT(worst.bias, 1e-5) << "d = " << order;
    EXPECT_LT(worst.sigma, 1e-5) << "d = " << order;
  }
}

/// Verifies SR-PRED-02.
TEST(KalmanPredictorWithEveryKindOfMode, EqualsADenseDoubleFilter) {
  for (const Start start : {Start::zero, Start::stationary}) {
    const auto worst = compare(mixed_modes(start), 100.0, 2.0, 40, 200, 20'000);
    EXPECT_LT(worst.bias, 1e-5);
    EXPECT_LT(worst.sigma, 1e-5);
  }
}

/// Verifies SR-PRED-04.
TEST(KalmanPredictorHeading, HasTheConditionalVariance) {
  const auto modes = mixed_modes(Start::stationary);
  constexpr int kStop = 30, kLead = 4, kDrive = 90, n = kStop + kLead + kDrive;
  constexpr double r = 2.0;
  // Oracle: condition the sum on the stop's measurements, the unknown level by least squares (GLS).
  const Eigen::MatrixXd c = testing::bias_covariance(modes, n);
  const Eigen::MatrixXd y_cov =
      c.topLeftCorner(kStop, kStop) + r * Eigen::MatrixXd::Identity(kStop, kStop);
  const Eigen::VectorXd sum = [&] {
    Eigen::VectorXd a = Eigen::VectorXd::Zero(n);
    a.tail(kDrive).setOnes();
    return a;
  }();
  const Eigen::VectorXd cross = (c * sum).head(kStop);
  const Eigen::LDLT<Eigen::MatrixXd> solver(y_cov);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(kStop);
  const double information = ones.dot(solver.solve(ones));
  const double unexplained = kDrive - ones.dot(solver.solve(cross));
  const double variance =
      sum.dot(c * sum) - cross.dot(solver.solve(cross)) + unexplained * unexplained / information;

  const KalmanCoefficients coefficients{modes};
  KalmanPredictor filter{coefficients};
  SimulatedSensor sensor{modes, 5.0, r, 3};
  Eigen::VectorXd y(kStop);
  for (int k = 0; k < kStop; ++k) {
    filter.advance(modes.one_tick());
    y(k) = double{sensor.next()};
    filter.observe(static_cast<float>(y(k)), static_cast<float>(r));
  }
  const double level = ones.dot(solver.solve(y)) / information;
  const double expected = kDrive * level + cross.dot(solver.solve(y - level * ones));
  const HeadingPrediction heading = filter.predict_heading(modes.over(kLead), modes.over(kDrive));
  EXPECT_NEAR(double{heading.angle_rad} / expected, 1.0, 1e-4);
  EXPECT_NEAR(double{heading.variance_rad2} / variance, 1.0, 1e-4);
}

/// Verifies SR-INT-01.
TEST(KalmanPredictorBeforeTheFirstMeasurement, HasInfiniteVariance) {
  const auto modes = mixed_modes(Start::stationary);
  const KalmanCoefficients coefficients{modes};
  const KalmanPredictor filter{coefficients};
  EXPECT_FALSE(filter.predict(modes.over(1)).is_available());
  EXPECT_FALSE(filter.predict_heading(modes.over(1), modes.over(10)).is_available());
}

TEST(KalmanPredictorGivenNonsense, RefusesItAndStaysAsItWas) {
  const auto modes = mixed_modes(Start::stationary);
  const KalmanCoefficients coefficients{modes};
  KalmanPredictor filter{coefficients};
  filter.observe(1.0F, 2.0F);
  filter.advance(modes.one_tick());
  filter.observe(1.5F, 2.0F);
  const auto before = filter.state();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const auto& [rate, variance] : {std::pair{kNan, 1.0F},
                                       {kInf, 1.0F},
                                       {-kInf, 1.0F},
                                       {1.0F, kNan},
                                       {1.0F, 0.0F},
                                       {1.0F, -1.0F},
                                       {1.0F, kInf}}) {
    EXPECT_FALSE(filter.observe(rate, variance).accepted) << rate << ", " << variance;
    EXPECT_EQ(std::memcmp(&before, &filter.state(), sizeof before), 0);
  }
}

/// Verifies SR-PRED-03.
TEST(KalmanPredictorThatCrossesOneTickAsAGap, AgreesWithTheStep) {
  const auto modes = mixed_modes(Start::stationary);
  const KalmanCoefficients coefficients{modes};
  KalmanPredictor stepped{coefficients};
  KalmanPredictor crossed{coefficients};
  SimulatedSensor sensor{modes, 3.0, 1.0, 13};
  for (int k = 0; k < 2000; ++k) {
    const float y = sensor.next();
    stepped.step(modes.one_tick(), y, 1.0F);
    crossed.advance(modes.one_tick());
    crossed.observe(y, 1.0F);
  }
  const Prediction a = stepped.predict(modes.over(50));
  const Prediction b = crossed.predict(modes.over(50));
  EXPECT_NEAR(a.bias_rad_s, b.bias_rad_s, 1e-4F * a.sigma_rad_s());
  EXPECT_NEAR(a.sigma_rad_s() / b.sigma_rad_s(), 1.0F, 1e-5F);
}

TEST(KalmanPredictorRestoredFromItsState, ContinuesBitForBit) {
  const auto modes = mixed_modes(Start::stationary);
  const auto tick = modes.one_tick();
  SimulatedSensor sensor{modes, 3.0, 1.0, 11};
  const KalmanCoefficients coefficients{modes};
  KalmanPredictor uninterrupted{coefficients};
  for (int k = 0; k < 500; ++k) {
    uninterrupted.step(tick, sensor.next(), 1.0F);
  }
  KalmanPredictor resumed{coefficients};
  resumed.restore(uninterrupted.state());
  for (int k = 0; k < 500; ++k) {
    const float y = sensor.next();
    for (auto* filter : {&uninterrupted, &resumed}) {
      filter->step(tick, y, 1.0F);
    }
  }
  EXPECT_EQ(std::memcmp(&uninterrupted.state(), &resumed.state(), sizeof resumed.state()), 0);
}

/// Verifies SR-INT-02.
TEST(KalmanPredictorUnderItsOwnModel, HasInnovationsOfVariance1) {
  const Duration tick = Duration::seconds(1);
  const auto modes = compose(tick, Start::stationary, flicker_like<5>(tick, 0.5));
  const KalmanCoefficients coefficients{modes};
  const auto step = modes.one_tick();
  double sum = 0.0;
  int n = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    SimulatedSensor sensor{modes, 0.0, 3.0, seed};
    KalmanPredictor filter{coefficients};
    for (int k = 0; k < 2000; ++k) {
      const Innovation innovation = filter.step(step, sensor.next(), 3.0F);
      if (innovation.first) continue;
      sum += double{innovation.normalised_squared()};
      ++n;
    }
  }
  // White innovations: the mean of n chi-squared(1) has the standard deviation sqrt(2 / n).
  EXPECT_NEAR(sum / n, 1.0, 4.0 * std::sqrt(2.0 / n));
}

}  // namespace
}  // namespace zerorate::core
