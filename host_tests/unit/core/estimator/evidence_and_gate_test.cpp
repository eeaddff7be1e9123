#include "core/estimator/evidence.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <random>

#include "core/estimator/gate.hpp"
#include "core/estimator/kalman_predictor.hpp"
#include "host_tests/support/sample_modes.hpp"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::core {
namespace {

constexpr std::size_t kHypotheses = 3;
constexpr std::array kVariances{0.25F, 1.0F, 4.0F};
constexpr std::array kLogPriors{-0.5F, 0.0F, -0.25F};
using Three = Evidence<kHypotheses, 2>;

/// Hypotheses as a filter is given them.
struct Given {
  struct One {
    float log_prior = 0.0F;
    [[nodiscard]] static float first_log_evidence() { return 0.0F; }
  };
  std::size_t count = kHypotheses;
  float kept = 1.0F;
  std::array<One, kHypotheses> all{{{kLogPriors[0]}, {kLogPriors[1]}, {kLogPriors[2]}}};
};

/// Variance that a hypothesis predicts for a measurement: no two have a constant ratio.
float variance(std::size_t m, std::int64_t k) {
  return k % 10 == 0 ? 5.0F * kVariances[m] : 1.0F + 0.1F * static_cast<float>(m);
}

/// Residual of measurement k on an axis: the second hypothesis is right, at a scale of 9 or 1.
float residual(std::int64_t k, std::size_t axis) {
  const random::RandomStream noise{5, axis};
  const double scale = axis == 0 ? 9.0 : 1.0;
  return static_cast<float>(std::sqrt(scale * double{variance(1, k)}) * noise.normal(k));
}

Three told(std::int64_t measurements, float kept = 1.0F) {
  Three evidence;
  const Given given{.kept = kept};
  evidence.start(given, 1.0F);
  for (std::size_t i = 0; i < 2; ++i) evidence.weigh(given, i);
  for (std::int64_t k = 0; k < measurements; ++k) {
    for (std::size_t m = 0; m < kHypotheses; ++m) {
      for (std::size_t i = 0; i < 2; ++i) {
        evidence.observe(m, i, variance(m, k), residual(k, i), kept);
      }
    }
    evidence.conclude(given);
    for (std::size_t i = 0; i < 2; ++i) evidence.weigh(given, i);
  }
  return evidence;
}

/// The normal-inverse-gamma posterior of all measurements at once.
struct Batch {
  double shape = double{Three::kPriorShape};
  double rate = double{Three::kPriorShape};
  double log_evidence = 0.0;
};
Batch batch(std::int64_t measurements, std::size_t m, std::size_t axis) {
  Batch posterior;
  for (std::int64_t k = 0; k < measurements; ++k) {
    const double e = double{residual(k, axis)};
    posterior.shape += 0.5;
    posterior.rate += 0.5 * e * e / double{variance(m, k)};
    posterior.log_evidence -= 0.5 * std::log(double{variance(m, k)});
  }
  posterior.log_evidence -= posterior.shape * std::log(posterior.rate);
  return posterior;
}

/// Verifies SR-LEARN-17.
TEST(EvidenceOfManyMeasurements, IsThatOfTheConjugatePosterior) {
  constexpr std::int64_t kMeasurements = 40;
  const Three evidence = told(kMeasurements);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    std::array<double, kHypotheses> expected{};
    double sum = 0.0;
    for (std::size_t m = 0; m < kHypotheses; ++m) {
      // Less that of the second hypothesis, so that no exponential overflows.
      const auto gained = [&](std::size_t of_axis) {
        return batch(kMeasurements, m, of_axis).log_evidence -
               batch(kMeasurements, 1, of_axis).log_evidence;
      };
      expected[m] = std::exp(double{kLogPriors[m]} + gained(axis) + 0.2 * gained(1 - axis));
      sum += expected[m];
    }
    for (std::size_t m = 0; m < kHypotheses; ++m) {
      const Batch one = batch(kMeasurements, m, axis);
      EXPECT_NEAR(double{evidence.hypotheses[m][axis].weight}, expected[m] / sum, 2e-5) << m;
      EXPECT_NEAR(double{evidence.hypotheses[m][axis].scale}, one.rate / one.shape,
                  2e-5 * one.rate);
      EXPECT_NEAR(double{evidence.mean_scale(m, axis)}, one.rate / (one.shape - 1.0),
                  2e-5 * one.rate);
    }
  }
}

/// Verifies SR-LEARN-17.
TEST(EvidenceOfManyMeasurements, FindsHypothesisAndScales) {
  const Three evidence = told(4000);
  EXPECT_GT(evidence.hypotheses[1][0].weight, 0.99F);
  EXPECT_GT(evidence.hypotheses[1][1].weight, 0.99F);
  // The relative error of a variance of n measurements is sqrt(2 / n): four of them.
  const double tolerance = 4.0 * std::sqrt(2.0 / 4000.0);
  EXPECT_NEAR(double{evidence.hypotheses[1][0].scale}, 9.0, 9.0 * tolerance);
  EXPECT_NEAR(double{evidence.hypotheses[1][1].scale}, 1.0, tolerance);
}

TEST(EvidenceThatFades, RestsOnTheNewestMeasurements) {
  constexpr float kKept = 0.99F;  // a memory of a hundred measurements
  const Three evidence = told(4000, kKept);
  EXPECT_NEAR(evidence.shape, 0.5F / (1.0F - kKept), 0.5F);
}

TEST(EvidenceBeforeAnyMeasurement, IsThePrior) {
  const Three evidence = told(0);
  float sum = 0.0F;
  for (const float log_prior : kLogPriors) sum += std::exp(log_prior);
  for (std::size_t m = 0; m < kHypotheses; ++m) {
    EXPECT_NEAR(evidence.hypotheses[m][0].weight, std::exp(kLogPriors[m]) / sum, 1e-6F);
  }
}

/// Verifies SR-INT-12.
TEST(EvidenceOfAnImpossibleMeasurement, StaysFinite) {
  Three evidence = told(100);
  for (std::size_t m = 0; m < kHypotheses; ++m) {
    evidence.observe(m, 0, 1e-12F, 1e6F, 1.0F);
    evidence.observe(m, 1, 1e-30F, 0.0F, 1.0F);
  }
  evidence.conclude(Given{});
  for (std::size_t i = 0; i < 2; ++i) evidence.weigh(Given{}, i);
  for (std::size_t m = 0; m < kHypotheses; ++m) {
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_TRUE(is_finite(evidence.hypotheses[m][i].weight));
      EXPECT_TRUE(is_finite_positive(evidence.hypotheses[m][i].scale));
    }
  }
}

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

/// Verifies SR-LEARN-12.
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

/// Verifies SR-INT-06.
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

/// Verifies SR-LEARN-13.
TEST_F(SettledFilter, ReacquiresAJumpWhenItHasLastedLongerThanAKnock) {
  for (int k = 0; k < kLongestKnock; ++k) EXPECT_TRUE(feed(normal(400.0F)).rejected);
  EXPECT_TRUE(feed(normal(400.0F)).accepted);
  EXPECT_NEAR(predicted().bias_rad_s, 400.0F, 4.0F * predicted().sigma_rad_s());
  EXPECT_LT(predicted().sigma_rad_s(), 3.0F);
  for (int k = 0; k < 100; ++k) EXPECT_FALSE(feed(normal(400.0F)).rejected);
}

/// Verifies SR-LEARN-13.
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

/// Verifies SR-LEARN-14.
TEST_F(FreshFilter, IsConfirmedByASecondOfMeasurementsThatAgree) {
  for (int k = 0; k < 2; ++k) {
    EXPECT_FALSE(filter.state().is_confirmed()) << k;
    feed(normal(-700.0F));
  }
  EXPECT_TRUE(filter.state().is_confirmed());
}

/// Verifies SR-LEARN-14.
TEST_F(FreshFilter, BeginsAnewWhereTheSecondMeasurementDisagrees) {
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
