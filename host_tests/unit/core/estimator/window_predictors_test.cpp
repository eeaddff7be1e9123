#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "core/estimator/bias_predictor.hpp"
#include "core/estimator/calibration_mean.hpp"
#include "core/estimator/moving_average.hpp"
#include "core/estimator/suffix_sums.hpp"
#include "host_tests/support/dense_noise.hpp"
#include "host_tests/support/sample_modes.hpp"

namespace zerorate::core {
namespace {

using testing::mixed_modes;

static_assert(BiasPredictor<CalibrationMean<ModelShape{.decaying = 6}>>);
static_assert(BiasPredictor<MovingAverage<ModelShape{.decaying = 5, .rotating = 1}>>);

constexpr double kWhite = 2.0;

/// Feeds a stop of `stop` ticks that begins `age` ticks after the start; returns what was fed.
template <class Predictor, class ModesType>
Eigen::VectorXd feed(Predictor& predictor, const ModesType& modes, int age, int stop) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal(0.4F, 1.0F);
  Eigen::VectorXd y(stop);
  if (age > 0) predictor.advance(modes.over(static_cast<std::uint32_t>(age)));
  for (int k = 0; k < stop; ++k) {
    predictor.advance(modes.one_tick());
    const float rate = normal(random);
    y(k) = double{rate};
    EXPECT_TRUE(predictor.observe(rate, static_cast<float>(kWhite)).accepted);
  }
  return y;
}

/// The paper's weights on the stop's measurements for the tick `ahead` after the newest.
Eigen::VectorXd moving_average_weights(int stop, int ahead) {
  const int length = std::min(ahead, stop);
  Eigen::VectorXd a = Eigen::VectorXd::Zero(stop);
  a.tail(length).setConstant(1.0 / length);
  return a;
}
Eigen::VectorXd mean_weights(int stop, int /*ahead*/) {
  return Eigen::VectorXd::Constant(stop, 1.0 / stop);
}

/// Error variance of sum_j (bias at tick j - weights_j'y), j in [from, to], from the covariance
/// written out.
template <class ModesType, class Weights>
double error_variance(const ModesType& modes, int age, int stop, int from, int to,
                      Weights weights) {
  const int n = age + stop + to;
  Eigen::VectorXd bias_weights = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd on_y = Eigen::VectorXd::Zero(stop);
  for (int j = from; j <= to; ++j) {
    bias_weights(age + stop + j - 1) += 1.0;
    on_y += weights(stop, j);
  }
  bias_weights.segment(age, stop) -= on_y;
  return bias_weights.dot(testing::bias_covariance(modes, n) * bias_weights) +
         kWhite * on_y.squaredNorm();
}

template <class Predictor, class Weights>
void expect_intervals_of(Start start, Weights weights, double heading_tolerance) {
  const auto modes = mixed_modes(start);
  constexpr int kAge = 25, kStop = 150;
  Predictor predictor{modes};
  const Eigen::VectorXd y = feed(predictor, modes, kAge, kStop);
  for (const int ahead : {1, 5, 60, 149, 150, 151, 400}) {
    const auto lead = modes.over(static_cast<std::uint32_t>(ahead));
    const Prediction prediction = predictor.predict(lead);
    EXPECT_NEAR(double{prediction.bias_rad_s}, weights(kStop, ahead).dot(y), 2e-2) << ahead;
    EXPECT_EQ(prediction.bias_rad_s, predictor.bias_rad_s(lead));
    EXPECT_NEAR(double{prediction.variance_rad2_s2} /
                    error_variance(modes, kAge, kStop, ahead, ahead, weights),
                1.0, 1e-4)
        << ahead;
  }
  for (const auto& [lead, drive] : {std::pair{0, 1}, {0, 40}, {7, 100}, {10, 500}, {200, 50}}) {
    const HeadingPrediction heading =
        predictor.predict_heading(modes.over(static_cast<std::uint32_t>(lead)),
                                  modes.over(static_cast<std::uint32_t>(drive)));
    double angle = 0.0;
    for (int j = lead + 1; j <= lead + drive; ++j) angle += weights(kStop, j).dot(y);
    EXPECT_NEAR(double{heading.angle_rad} / angle, 1.0, heading_tolerance) << lead << "+" << drive;
    EXPECT_NEAR(double{heading.variance_rad2} /
                    error_variance(modes, kAge, kStop, lead + 1, lead + drive, weights),
                1.0, heading_tolerance)
        << lead << "+" << drive;
  }
}

/// Verifies SR-INT-11.
TEST(CalibrationMean, HasTheIntervalsOfTheExplicitCovariance) {
  expect_intervals_of<CalibrationMean<ModelShape{.decaying = 5, .rotating = 1}>>(
      Start::stationary, mean_weights, 1e-4);
  expect_intervals_of<CalibrationMean<ModelShape{.decaying = 5, .rotating = 1}>>(
      Start::zero, mean_weights, 1e-4);
}

/// Verifies SR-INT-11.
TEST(MovingAverage, HasTheIntervalsOfTheExplicitCovariance) {
  // The heading's weights are taken block by block: 2 % is what that may cost.
  expect_intervals_of<MovingAverage<ModelShape{.decaying = 5, .rotating = 1}>>(
      Start::stationary, moving_average_weights, 2e-2);
  expect_intervals_of<MovingAverage<ModelShape{.decaying = 5, .rotating = 1}>>(
      Start::zero, moving_average_weights, 2e-2);
}

TEST(WindowPredictorsAtANewStop, StartAgain) {
  const auto modes = mixed_modes(Start::stationary);
  CalibrationMean mean{modes};
  MovingAverage average{modes};
  for (const float rate : {5.0F, 7.0F}) mean.observe(rate, 1.0F), average.observe(rate, 1.0F);
  mean.begin_stop();
  average.begin_stop();
  EXPECT_FLOAT_EQ(mean.bias_rad_s(modes.over(9)), 6.0F)
      << "the old stop stands until the next measurement";
  mean.observe(1.0F, 1.0F);
  average.observe(1.0F, 1.0F);
  EXPECT_EQ(mean.bias_rad_s(modes.over(9)), 1.0F);
  EXPECT_EQ(average.bias_rad_s(modes.over(9)), 1.0F);
}

TEST(WindowPredictorsGivenNonsense, RefuseItAndStayAsTheyWere) {
  const auto modes = mixed_modes(Start::stationary);
  CalibrationMean mean{modes};
  MovingAverage average{modes};
  mean.observe(1.0F, 1.0F);
  average.observe(1.0F, 1.0F);
  const auto mean_before = mean.state();
  const auto average_before = average.state();
  for (const float nonsense :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    EXPECT_FALSE(mean.observe(nonsense, 1.0F).accepted);
    EXPECT_FALSE(average.observe(nonsense, 1.0F).accepted);
    EXPECT_FALSE(average.observe(1.0F, nonsense).accepted);
  }
  EXPECT_EQ(std::memcmp(&mean_before, &mean.state(), sizeof mean_before), 0);
  EXPECT_EQ(std::memcmp(&average_before, &average.state(), sizeof average_before), 0);
}

/// Noise with a slow part, so that a block's two parts differ.
std::vector<float> wandering_rates(std::size_t n) {
  std::mt19937 random(42);
  std::normal_distribution<float> normal;
  std::vector<float> rates(n);
  float slow = 0.0F;
  for (float& rate : rates) {
    slow += 0.05F * normal(random);
    rate = slow + normal(random);
  }
  return rates;
}

TEST(SuffixSums, AreExactForTheNewestMeasurements) {
  const auto rates = wandering_rates(100'000);
  SuffixSums<> sums;
  for (const float rate : rates) sums.push(rate);
  float exact = 0.0F;
  for (std::uint32_t length = 1; length < SuffixSums<>::kExact; ++length) {
    exact += rates[rates.size() - length];
    EXPECT_EQ(sums.sum_of_newest(length), exact);
  }
}

TEST(SuffixSums, StayWithinTheStatedDeviationOfTheExactMean) {
  const auto rates = wandering_rates(300'000);
  const double fraction = 1.0 / (4.0 * (SuffixSums<>::kPerLevel - 1));
  SuffixSums<> sums;
  std::vector<double> prefix{0.0};
  for (const float rate : rates) {
    sums.push(rate);
    prefix.push_back(prefix.back() + double{rate});
  }
  const auto mean_between = [&](std::size_t from, std::size_t to) {
    return (prefix[to] - prefix[from]) / static_cast<double>(to - from);
  };
  std::size_t newer = 0;
  sums.for_each_newest_first([&](std::uint32_t size, float) {
    const std::size_t newest = rates.size() - newer;
    for (std::size_t part = 1; part < size; part += std::max<std::size_t>(1, size / 7)) {
      const auto length = static_cast<std::uint32_t>(newer + part);
      const double exact = mean_between(rates.size() - length, rates.size());
      const double halves = std::abs(mean_between(newest - part, newest) -
                                     mean_between(newest - size, newest - part));
      const double deviation = std::abs(double{sums.sum_of_newest(length)} / length - exact);
      EXPECT_LE(deviation, fraction * halves + 1e-4) << "suffix of " << length;
    }
    newer += size;
    return true;
  });
  EXPECT_EQ(newer, rates.size());
}

}  // namespace
}  // namespace zerorate::core
