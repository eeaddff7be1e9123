#include "core/estimator/gate.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "core/estimator/kalman_predictor.hpp"
#include "host_tests/support/sample_modes.hpp"

namespace zerorate::core {
namespace {

constexpr Duration kTick = Duration::milliseconds(500);
constexpr float kWhiteVariance = 4.0F;
constexpr std::uint16_t kLongestKnock = 10;
constexpr Gate kGate{.threshold_sigma = 5.0F, .longest_knock_ticks = kLongestKnock};

/// A filter with a gate that has learnt the level 100 for 500 ticks.
class SettledFilter : public ::testing::Test {
 protected:
  SettledFilter() {
    for (int k = 0; k < 500; ++k) EXPECT_FALSE(feed(normal(100.0F)).rejected);
  }
  float normal(float level) { return level + 2.0F * normal_(random_); }
  Innovation feed(float y) { return filter.step(modes.one_tick(), y, kWhiteVariance); }
  [[nodiscard]] Prediction predicted() const { return filter.predict(modes.one_tick()); }

  Modes<6, 0> modes = compose(kTick, Start::stationary, testing::flicker_like<6>(kTick, 0.5));
  KalmanCoefficients<ModelShape{.decaying = 6}> coefficients{modes, kGate};
  KalmanPredictor<ModelShape{.decaying = 6}> filter{coefficients};

 private:
  std::mt19937 random_{4};
  std::normal_distribution<float> normal_;
};

TEST_F(SettledFilter, RejectsAKnockAndLearnsNothingFromIt) {
  const Prediction before = predicted();
  for (int k = 0; k < 3; ++k) {
    const Innovation knock = feed(1000.0F);
    EXPECT_TRUE(knock.rejected);
    EXPECT_FALSE(knock.accepted);
  }
  // The modes forget a little in three ticks, no more.
  EXPECT_NEAR(predicted().bias_rad_s, before.bias_rad_s, 0.5F * before.sigma_rad_s());
  feed(normal(100.0F));
  EXPECT_LT(predicted().sigma_rad_s(), 1.2F * before.sigma_rad_s());
}

TEST_F(SettledFilter, DoubtsMoreAndMoreWhileTheKnockLasts) {
  float last = predicted().sigma_rad_s();
  for (int k = 1; k <= kLongestKnock; ++k) {
    feed(1000.0F);
    EXPECT_GT(predicted().sigma_rad_s(), last);
    last = predicted().sigma_rad_s();
  }
  EXPECT_GT(last, 890.0F);  // the whole jump, in case it is one
  EXPECT_GT(filter.predict_heading(modes.over(0), modes.over(20)).sigma_rad(), 890.0F * 10.0F);
}

TEST_F(SettledFilter, ReacquiresAJumpWhenItHasLastedLongerThanAKnock) {
  for (int k = 0; k < kLongestKnock; ++k) EXPECT_TRUE(feed(normal(400.0F)).rejected);
  EXPECT_TRUE(feed(normal(400.0F)).accepted);
  EXPECT_NEAR(predicted().bias_rad_s, 400.0F, 4.0F * predicted().sigma_rad_s());
  EXPECT_LT(predicted().sigma_rad_s(), 3.0F);
  for (int k = 0; k < 100; ++k) EXPECT_FALSE(feed(normal(400.0F)).rejected);
}

TEST_F(SettledFilter, IsNotLockedOutByAJumpOfAnySize) {
  for (const float level : {115.0F, 130.0F, 1e4F, -1e6F, 0.0F}) {
    for (int k = 0; k < 3 * kLongestKnock; ++k) feed(normal(level));
    EXPECT_NEAR(predicted().bias_rad_s, level, 5.0F * predicted().sigma_rad_s() + 1e-6F * 1e6F)
        << level;
  }
}

/// A filter with a gate that has measured once.
class FreshFilter : public SettledFilter {
 protected:
  FreshFilter() {
    filter = KalmanPredictor<ModelShape{.decaying = 6}>{coefficients};
    feed(-700.0F);
  }
};

TEST_F(FreshFilter, IsConfirmedByASecondOfMeasurementsThatAgree) {
  for (int k = 0; k < 2; ++k) {
    EXPECT_FALSE(filter.state().is_confirmed()) << k;
    feed(normal(-700.0F));
  }
  EXPECT_TRUE(filter.state().is_confirmed());
}

TEST_F(FreshFilter, BeginsAnewFromAMeasurementThatContradictsTheFirst) {
  feed(normal(-700.0F));
  EXPECT_TRUE(feed(normal(100.0F)).first);
  EXPECT_FALSE(filter.state().is_confirmed());
  EXPECT_NEAR(predicted().bias_rad_s, 100.0F, 5.0F * predicted().sigma_rad_s());
  for (int k = 0; k < 2; ++k) EXPECT_TRUE(feed(normal(100.0F)).accepted);
  EXPECT_TRUE(filter.state().is_confirmed());
  EXPECT_TRUE(feed(-700.0F).rejected);
}

TEST(FilterOfSlowTicks, IsConfirmedByASecondMeasurement) {
  constexpr Duration kMinute = Duration::seconds(60);
  const auto modes = compose(kMinute, Start::stationary, testing::flicker_like<6>(kMinute, 60.0));
  const KalmanCoefficients<ModelShape{.decaying = 6}> coefficients{modes};
  KalmanPredictor filter{coefficients};
  EXPECT_FALSE(filter.state().is_measured());
  filter.step(modes.one_tick(), 1.0F, kWhiteVariance);
  EXPECT_TRUE(filter.state().is_measured());
  EXPECT_FALSE(filter.state().is_confirmed());
  filter.step(modes.one_tick(), 1.0F, kWhiteVariance);
  EXPECT_TRUE(filter.state().is_confirmed());
}

TEST(GateThatIsNeverPassed, ChangesNothing) {
  const auto modes = compose(kTick, Start::stationary, testing::flicker_like<6>(kTick, 0.5));
  const KalmanCoefficients<ModelShape{.decaying = 6}> open{modes};
  const KalmanCoefficients<ModelShape{.decaying = 6}> gated{
      modes, Gate{.threshold_sigma = 50.0F, .longest_knock_ticks = kLongestKnock}};
  KalmanPredictor free{open};
  KalmanPredictor guarded{gated};
  std::mt19937 random{9};
  std::normal_distribution<float> normal{0.0F, 3.0F};
  for (int k = 0; k < 1000; ++k) {
    const float y = normal(random);
    free.step(modes.one_tick(), y, kWhiteVariance);
    EXPECT_TRUE(guarded.step(modes.one_tick(), y, kWhiteVariance).accepted);
  }
  // One goes through registers, the other through memory: the last bits differ.
  EXPECT_NEAR(free.state().filters[0].axes[0].bias_rad_s,
              guarded.state().filters[0].axes[0].bias_rad_s, 1e-4F);
  EXPECT_NEAR(free.state().filters[0].bias_variance / guarded.state().filters[0].bias_variance,
              1.0F, 1e-5F);
}

}  // namespace
}  // namespace zerorate::core
