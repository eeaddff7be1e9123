#include "core/estimator/kalman_bank.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/estimator/kalman_predictor.hpp"
#include "core/noise/harmonic.hpp"
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

// The oracle is a filter of a model whose slow noise is that much stronger.
TEST(KalmanBankInAUnit, EstimatesAsIfTheSlowNoiseWereSoManyTimesStronger) {
  constexpr float kUnit = 9.0F;
  auto plain = modes();
  auto strong = modes();
  for (auto& mode : strong.decaying) {
    mode.noise_variance *= kUnit;
    mode.initial_variance *= kUnit;
  }
  for (auto& mode : strong.rotating) {
    mode.noise_variance *= kUnit;
    mode.initial_variance *= kUnit;
  }
  const KalmanCoefficients<kShape> of_plain{plain, kGate};
  const KalmanCoefficients<kShape> of_strong{strong, kGate};
  Bank bank{of_plain};
  Bank oracle{of_strong};
  for (std::int64_t k = 0; k < 300; ++k) {
    auto rates = measured(k);
    if (k >= 200 && k < 203) rates[0] += 100.0F;  // a knock
    if (k >= 250) rates[1] += 100.0F;             // a jump
    bank.advance(plain.one_tick());
    oracle.advance(strong.one_tick());
    const auto innovations = bank.observe(rates, kWhiteVariance, kUnit);
    const auto expected = oracle.observe(rates, kWhiteVariance);
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_EQ(innovations[i].rejected, expected[i].rejected) << k;
      ASSERT_NEAR(innovations[i].variance_rad2_s2, expected[i].variance_rad2_s2,
                  1e-4F * expected[i].variance_rad2_s2)
          << k;
    }
  }
  const auto lead = plain.over(20);
  const auto predicted = bank.predict(lead);
  const auto expected = oracle.predict(strong.over(20));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(predicted[i].bias_rad_s, expected[i].bias_rad_s, 2e-3F);
    EXPECT_NEAR(predicted[i].variance_rad2_s2 * kUnit, expected[i].variance_rad2_s2,
                1e-3F * expected[i].variance_rad2_s2);
  }
}

TEST(KalmanBankWhoseOneAxisIsKnocked, RejectsTheTickForAllAndDoubtsEachByItsOwn) {
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
  EXPECT_EQ(bank.state().covariance, silent.state().covariance);
  EXPECT_EQ(bank.state().bias_variance, silent.state().bias_variance);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(bank.state().axes[i].drift, silent.state().axes[i].drift);
    EXPECT_EQ(bank.state().axes[i].bias_rad_s, silent.state().axes[i].bias_rad_s);
  }
  // A fifth of the square of each axis' residual: 1,000 and some sigmas of 2.
  EXPECT_NEAR(bank.state().axes[1].rejection_variance, 2e5F, 1e4F);
  EXPECT_LT(bank.state().axes[0].rejection_variance, 100.0F);
  bank.advance(tick);
  EXPECT_TRUE(bank.observe(measured(101), kWhiteVariance)[1].accepted);
  EXPECT_EQ(bank.state().axes[1].rejection_variance, 0.0F);
}

TEST(KalmanBankWhoseOneAxisJumps, LearnsAllAnewOnceTheJumpHasLasted) {
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

TEST(KalmanBankWhoseTemperatureIsUnknown,
     TakesTheLargestSlopeForTheCovarianceAndEachItsOwnToPredict) {
  constexpr ModelShape kWarm{.decaying = 5, .rotating = 1, .temperature_weights = 2};
  const auto noise = modes();
  const KalmanCoefficients<kWarm> coefficients{noise, {}, {.slope_rad_s_per_k = 1.0F}};
  KalmanBank<kWarm, 3> bank{coefficients};
  (void)bank.observe({1.0F, 2.0F, 3.0F}, kWhiteVariance);
  auto state = bank.state();
  state.axes[2].drift[coefficients.kTemperature] = 3.0F;  // three times the slope of the others
  bank.restore(state);
  KalmanBank<kWarm, 3> knowing = bank;
  KalmanBank<kWarm, 3>::Transition gap{noise.over(8)};
  const auto known = bank.predict(gap);
  knowing.advance(gap);
  gap.temperature.unknown = {2.0F, 0.0F};  // 2 K
  const auto unknown = bank.predict(gap);
  EXPECT_FLOAT_EQ(unknown[0].variance_rad2_s2, known[0].variance_rad2_s2 + 4.0F);
  EXPECT_FLOAT_EQ(unknown[2].variance_rad2_s2, known[2].variance_rad2_s2 + 36.0F);
  bank.advance(gap);
  EXPECT_FLOAT_EQ(bank.state().bias_variance, knowing.state().bias_variance + 36.0F);
}

}  // namespace
}  // namespace zerorate::core
