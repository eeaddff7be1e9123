#include "core/estimator/kalman_bank.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/estimator/kalman_predictor.hpp"
#include "core/noise/terms.hpp"
#include "host_tests/support/sample_modes.hpp"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::core {
namespace {

constexpr Duration kTick = Duration::milliseconds(100);
constexpr float kWhiteVariance = 4.0F;
constexpr ModelShape kShape{.decaying = 5, .rotating = 1};
constexpr Gate kGate{.threshold_sigma = 6.0F, .longest_knock_ticks = 5};
using Bank = KalmanBank<kShape, 3>;

ModesOf<kShape> modes() {
  return compose(kTick, Start::stationary, testing::flicker_like<5>(kTick, 0.5),
                 Harmonic{.rms_rad_s = 1.0F, .frequency_hz = 0.4F, .coherence_time_s = 30.0F});
}

/// White noise around 100, 200 and 300.
Bank::Rates measured(std::int64_t k) {
  Bank::Rates rates{};
  for (std::size_t i = 0; i < rates.size(); ++i) {
    const random::RandomStream noise{7, i};
    rates[i] = 100.0F * static_cast<float>(i + 1) + 2.0F * static_cast<float>(noise.normal(k));
  }
  return rates;
}

void learn(Bank& bank, const Bank::Transition& span, std::int64_t from, std::int64_t to) {
  for (std::int64_t k = from; k < to; ++k) {
    bank.advance(span);
    (void)bank.observe(measured(k), kWhiteVariance);
  }
}

TEST(KalmanBankOfThreeAxes, GivesTheBitsOfThreePredictors) {
  const auto noise = modes();
  const KalmanCoefficients<kShape> coefficients{noise};
  const auto tick = noise.one_tick();
  const auto gap = noise.over(137);
  Bank bank{coefficients};
  std::array<KalmanPredictor<kShape>, 3> alone{
      KalmanPredictor{coefficients}, KalmanPredictor{coefficients}, KalmanPredictor{coefficients}};
  for (std::int64_t k = 0; k < 200; ++k) {
    const auto& span = k % 50 == 49 ? gap : tick;
    bank.advance(span);
    const auto together = bank.observe(measured(k), kWhiteVariance);
    for (std::size_t i = 0; i < 3; ++i) {
      const Innovation one = alone[i].step(span, measured(k)[i], kWhiteVariance);
      ASSERT_EQ(together[i].residual_rad_s, one.residual_rad_s);
      ASSERT_EQ(together[i].variance_rad2_s2, one.variance_rad2_s2);
    }
  }
  const auto predicted = bank.predict(gap);
  const auto headings = bank.predict_heading(tick, gap);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(predicted[i].bias_rad_s, alone[i].predict(gap).bias_rad_s);
    EXPECT_EQ(predicted[i].variance_rad2_s2, alone[i].predict(gap).variance_rad2_s2);
    EXPECT_EQ(bank.bias_rad_s(gap, i), alone[i].bias_rad_s(gap));
    EXPECT_EQ(headings[i].angle_rad, alone[i].predict_heading(tick, gap).angle_rad);
    EXPECT_EQ(headings[i].variance_rad2, alone[i].predict_heading(tick, gap).variance_rad2);
  }
}

constexpr ModelShape kLearningShape = with_hypotheses(kShape, 3);
using LearningBank = KalmanBank<kLearningShape, 3>;
constexpr std::array kStrengths{0.5F, 1.0F, 9.0F};

/// All decaying modes a half, once and nine times as strong.
Hypotheses<kLearningShape> guesses() {
  Hypotheses<kLearningShape> all;
  all.count = kStrengths.size();
  for (std::size_t m = 0; m < all.count; ++m) {
    all.all[m].strength.fill(kStrengths[m]);
    all.all[m].log_prior = -0.1F * static_cast<float>(m);
  }
  return all;
}

/// The modes of one hypothesis as a model of its own.
ModesOf<kShape> strong_modes(float strength) {
  auto strong = modes();
  for (auto& mode : strong.decaying) {
    mode.noise_variance *= strength;
    mode.initial_variance *= strength;
  }
  return strong;
}

// The oracle is one bank a hypothesis, each of a known model, mixed in double precision.
TEST(KalmanBankOfThreeHypotheses, IsTheMixtureOfThreeBanks) {
  const auto base = modes();
  const auto hypotheses = guesses();
  const KalmanCoefficients<kLearningShape> coefficients{
      base, {}, kNoInputs<kLearningShape>, hypotheses};
  LearningBank bank{coefficients};
  std::array<ModesOf<kShape>, 3> models{};
  for (std::size_t m = 0; m < 3; ++m) models[m] = strong_modes(kStrengths[m]);
  const std::array<KalmanCoefficients<kShape>, 3> of_models{
      KalmanCoefficients{models[0]}, KalmanCoefficients{models[1]}, KalmanCoefficients{models[2]}};
  std::array<Bank, 3> alone{Bank{of_models[0]}, Bank{of_models[1]}, Bank{of_models[2]}};
  for (std::int64_t k = 0; k < 300; ++k) {
    const std::uint32_t ticks = k % 50 == 49 ? 137 : 1;
    bank.advance(base.over(ticks));
    (void)bank.observe(measured(k), kWhiteVariance);
    for (std::size_t m = 0; m < 3; ++m) {
      alone[m].advance(models[m].over(ticks));
      (void)alone[m].observe(measured(k), kWhiteVariance);
    }
  }
  constexpr std::uint32_t kDrive = 60;
  const auto predicted = bank.predict(base.over(20));
  const auto headings = bank.predict_heading(base.over(2), base.over(kDrive));
  for (std::size_t i = 0; i < 3; ++i) {
    // Seen from the level of the axis, so that the squares do not lose their digits.
    const double level = 100.0 * static_cast<double>(i + 1);
    const double turned = level * kDrive * 0.1;
    double bias = 0.0;
    double square = 0.0;
    double angle = 0.0;
    double angle_square = 0.0;
    double weights = 0.0;
    for (std::size_t m = 0; m < 3; ++m) {
      const double weight = double{bank.state().weight(m, i)};
      const double scale = double{bank.state().mean_scale(m, i)};
      const Prediction one = alone[m].predict(models[m].over(20))[i];
      const HeadingPrediction turn =
          alone[m].predict_heading(models[m].over(2), models[m].over(kDrive))[i];
      const double own = double{one.bias_rad_s} - level;
      const double own_angle = double{turn.angle_rad} - turned;
      weights += weight;
      bias += weight * own;
      square += weight * (scale * double{one.variance_rad2_s2} + own * own);
      angle += weight * own_angle;
      angle_square += weight * (scale * double{turn.variance_rad2} + own_angle * own_angle);
    }
    EXPECT_NEAR(weights, 1.0, 1e-6);
    EXPECT_NEAR(double{predicted[i].bias_rad_s} - level, bias, 1e-4);
    EXPECT_NEAR(double{bank.bias_rad_s(base.over(20), i)} - level, bias, 1e-4);
    const double variance = square - bias * bias;
    EXPECT_NEAR(double{predicted[i].variance_rad2_s2}, variance, 2e-3 * variance);
    EXPECT_NEAR(double{headings[i].angle_rad} - turned, angle, 1e-3);
    const double of_heading = angle_square - angle * angle;
    EXPECT_NEAR(double{headings[i].variance_rad2}, of_heading, 2e-3 * of_heading);
  }
}

TEST(KalmanBankOfThreeHypotheses, WithAKnownModelGivesTheBitsOfOne) {
  const auto base = modes();
  const Hypotheses<kLearningShape> none;
  const KalmanCoefficients<kLearningShape> coefficients{base, kGate, {}, none};
  const KalmanCoefficients<kShape> of_one{base, kGate};
  LearningBank bank{coefficients};
  Bank one{of_one};
  for (std::int64_t k = 0; k < 100; ++k) {
    bank.advance(base.one_tick());
    one.advance(base.one_tick());
    (void)bank.observe(measured(k), kWhiteVariance);
    (void)one.observe(measured(k), kWhiteVariance);
  }
  EXPECT_EQ(bank.state().filters[0].bias_variance, one.state().filters[0].bias_variance);
  EXPECT_EQ(bank.predict(base.over(9))[2].variance_rad2_s2,
            one.predict(base.over(9))[2].variance_rad2_s2);
}

/// Verifies SR-LEARN-12.
TEST(KalmanBankWhoseOneAxisIsKnocked, RejectsTheTickForAll) {
  const auto noise = modes();
  const KalmanCoefficients<kShape> coefficients{noise, kGate};
  const auto tick = noise.one_tick();
  Bank bank{coefficients};
  learn(bank, tick, 0, 100);
  Bank silent = bank;  // the tick had never been measured
  auto knocked = measured(100);
  knocked[1] += 1000.0F;
  for (Bank* one : {&bank, &silent}) one->advance(tick);
  for (const Innovation& innovation : bank.observe(knocked, kWhiteVariance)) {
    EXPECT_TRUE(innovation.rejected);
    EXPECT_FALSE(innovation.accepted);
  }
  EXPECT_EQ(bank.state().filters, silent.state().filters);
  // A fifth of the square of each axis' residual: 1,000 and some sigmas of 2.
  EXPECT_NEAR(bank.state().axes[1].rejection_variance, 2e5F, 1e4F);
  EXPECT_LT(bank.state().axes[0].rejection_variance, 100.0F);
  bank.advance(tick);
  EXPECT_TRUE(bank.observe(measured(101), kWhiteVariance)[1].accepted);
  EXPECT_EQ(bank.state().axes[1].rejection_variance, 0.0F);
}

/// Verifies SR-LEARN-13.
TEST(KalmanBankWhoseOneAxisJumps, LearnsAnewAfterTheGatesTime) {
  const auto noise = modes();
  const KalmanCoefficients<kShape> coefficients{noise, kGate};
  const auto tick = noise.one_tick();
  Bank bank{coefficients};
  learn(bank, tick, 0, 100);
  std::array<Innovation, 3> innovations{};
  for (std::int64_t k = 100; k <= 100 + kGate.longest_knock_ticks; ++k) {
    EXPECT_FALSE(innovations[0].accepted);
    auto jumped = measured(k);
    jumped[2] += 500.0F;
    bank.advance(tick);
    innovations = bank.observe(jumped, kWhiteVariance);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(innovations[i].accepted);
    // One measurement's sigma is 2; five of them.
    EXPECT_NEAR(bank.bias_rad_s(tick, i), i == 2 ? 800.0F : 100.0F * static_cast<float>(i + 1),
                10.0F);
  }
}

TEST(KalmanBankGivenOneBadRate, LearnsFromNone) {
  const auto noise = modes();
  const KalmanCoefficients<kShape> coefficients{noise};
  Bank bank{coefficients};
  learn(bank, noise.one_tick(), 0, 10);
  const Bank::State before = bank.state();
  EXPECT_FALSE(
      bank.observe({1.0F, std::numeric_limits<float>::quiet_NaN(), 1.0F}, kWhiteVariance)[0]
          .accepted);
  EXPECT_TRUE(bank.state() == before);
}

TEST(KalmanBankWhoseTemperatureIsUnknown, TakesTheLargestSlope) {
  constexpr ModelShape kWarm{.decaying = 5, .rotating = 1, .inputs = 2};
  const auto noise = modes();
  const InputTerms<2> terms = TemperatureDrift{.slope_rad_s_per_k = 1.0F}.terms();
  const KalmanCoefficients<kWarm> coefficients{noise, {}, terms};
  KalmanBank<kWarm, 3> bank{coefficients};
  (void)bank.observe({1.0F, 2.0F, 3.0F}, kWhiteVariance);
  auto state = bank.state();
  state.filters[0].axes[2].drift[coefficients.kFirstInput] =
      3.0F;  // three times the slope of the others
  bank.restore(state);
  KalmanBank<kWarm, 3> knowing = bank;
  KalmanBank<kWarm, 3>::Transition gap{noise.over(8)};
  const auto known = bank.predict(gap);
  knowing.advance(gap);
  gap.inputs.unknown = {2.0F, 0.0F};  // 2 K
  const auto unknown = bank.predict(gap);
  EXPECT_FLOAT_EQ(unknown[0].variance_rad2_s2, known[0].variance_rad2_s2 + 4.0F);
  EXPECT_FLOAT_EQ(unknown[2].variance_rad2_s2, known[2].variance_rad2_s2 + 36.0F);
  bank.advance(gap);
  EXPECT_FLOAT_EQ(bank.state().filters[0].bias_variance,
                  knowing.state().filters[0].bias_variance + 36.0F);
}

}  // namespace
}  // namespace zerorate::core
