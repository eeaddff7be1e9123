// The oracle: all references of a drive at once, by generalised least squares in double precision
// with a dense covariance, where the filter takes one after the other in single precision.

#include "core/heading/heading_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "core/heading/recent_turn.hpp"
#include "host_tests/unit/core/heading/known_source.hpp"

namespace zerorate::core {
namespace {

using Turn = HeadingFilter::Turn;
using Verdict = ReferenceVerdict;

constexpr float kTurn = 2.0F * std::numbers::pi_v<float>;
/// Winds of a road, a turn a second: what the gyro measures of it.
std::vector<float> road(std::size_t seconds, std::uint64_t seed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<float> step{0.0F, 0.05F};
  std::vector<float> turn_rad(seconds);
  float rate = 0.0F;
  for (float& turn : turn_rad) turn = rate = 0.9F * rate + step(random);
  return turn_rad;
}

TEST(HeadingFilter, IsLeastSquaresOverAllReferences) {
  constexpr std::size_t kSeconds = 60;
  const std::vector<float> turn_rad = road(kSeconds, 3);
  std::mt19937_64 random{4};
  std::normal_distribution<double> noise{0.0, double{kSigma_rad}};
  const double scale = 0.004;
  const double offset = double{0.005F * kRadPerDeg};

  HeadingFilter filter = filter_of_honest_references();
  filter.depart(kBiasVariance);
  // Unknowns of the oracle: first heading, scale factor, offset, bias.
  std::vector<Eigen::Vector4d> rows;
  std::vector<double> values;
  double truth = 0.3;
  double measured = 0.0;
  ASSERT_EQ(filter.take_heading(static_cast<float>(truth + noise(random)), kVariance, {}),
            Verdict::begun);
  const double first = double{filter.heading_rad({})};
  for (std::size_t k = 0; k < kSeconds; ++k) {
    const double turned = double{turn_rad[k]};
    measured += turned;
    truth += (turned - offset) / (1.0 + scale);
    filter.advance({turn_rad[k], 1.0F}, 0.0F, kBiasVariance);
    const double heading = truth + noise(random);
    ASSERT_EQ(filter.take_heading(static_cast<float>(heading), kVariance, {}), Verdict::learnt);
    const auto seconds = static_cast<double>(k + 1);
    rows.emplace_back(1.0, -measured, -seconds, -seconds);
    values.push_back(heading - first - measured);
  }
  Eigen::Matrix4d information = Eigen::Vector4d{
      1.0 / double{kVariance}, 1.0 / (0.02 * 0.02),
      1.0 / std::pow(double{kParams.offset_rad_s}, 2.0),
      1.0 / double{kBiasVariance}}.asDiagonal();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    information += rows[k] * rows[k].transpose() / double{kVariance};
    right += rows[k] * values[k] / double{kVariance};
  }
  const Eigen::Vector4d expected = information.ldlt().solve(right);
  const Eigen::Matrix4d covariance = information.inverse();
  // The factor of the noise is learnt beside, and the scale factor is known better all the time:
  // both change the weights by some percent.
  const double scale_sigma = std::sqrt(covariance(1, 1));
  EXPECT_NEAR(double{filter.scale_factor()}, expected[1], 0.5 * scale_sigma);
  EXPECT_NEAR(std::sqrt(double{filter.scale_factor_variance()}), scale_sigma, 0.4 * scale_sigma);
  const double bias_sigma = std::sqrt(covariance(2, 2) + covariance(3, 3) + 2.0 * covariance(2, 3));
  EXPECT_NEAR(double{filter.bias_in_motion_rad_s()}, expected[2] + expected[3], 0.5 * bias_sigma);
}

/// Verifies SR-HEAD-06.
TEST(HeadingFilter, LearnsNothingOfTheScaleFactorOnAStraightRoad) {
  HeadingFilter filter = filter_of_known_source();
  filter.depart(kBiasVariance);
  (void)filter.take_heading(1.0F, kVariance, {});
  for (int k = 0; k < 1000; ++k) {
    filter.advance({0.0F, 1.0F}, 0.0F, kBiasVariance);
    EXPECT_EQ(filter.take_heading(1.0F, kVariance, {}), Verdict::learnt);
  }
  EXPECT_NEAR(filter.scale_factor_variance(), kParams.scale_factor * kParams.scale_factor, 1e-6F);
  EXPECT_NEAR(filter.quality(), 0.0F, 1e-3F);
}

/// Verifies SR-HEAD-06.
TEST(HeadingFilter, LearnsTheScaleFactorFromTenTurns) {
  HeadingFilter filter = filter_of_known_source();
  filter.depart(kBiasVariance);
  const float measured = 10.0F * kTurn * 1.015F;
  EXPECT_EQ(filter.take_turn(10.0F * kTurn, kVariance, {measured, 60.0F}, 0.0F), Verdict::learnt);
  EXPECT_NEAR(filter.scale_factor(), 0.015F, 5e-4F);
  EXPECT_GT(filter.quality(), 0.95F);
  EXPECT_NEAR(filter.scaled(measured), 10.0F * kTurn, 0.03F);
}

TEST(HeadingFilter, TakesALateReferenceForWhatItWas) {
  HeadingFilter late = filter_of_honest_references();
  HeadingFilter timely = filter_of_honest_references();
  for (HeadingFilter* const filter : {&late, &timely}) {
    filter->depart(kBiasVariance);
    (void)filter->take_heading(0.0F, kVariance, {});
    filter->advance({0.8F, 4.0F}, 0.0F, kBiasVariance);
  }
  EXPECT_EQ(timely.take_heading(0.79F, kVariance, {}), Verdict::learnt);
  timely.advance({0.3F, 1.0F}, 0.0F, kBiasVariance);
  late.advance({0.3F, 1.0F}, 0.0F, kBiasVariance);
  EXPECT_EQ(late.take_heading(0.79F, kVariance, {-0.3F, -1.0F}), Verdict::learnt);
  // The product of two corrections of a hundredth remains.
  EXPECT_NEAR(late.heading_rad({}), timely.heading_rad({}), 1e-4F);
  EXPECT_NEAR(late.scale_factor(), timely.scale_factor(), 1e-6F);
}

TEST(HeadingFilter, KnowsThatAHeadingIsACircle) {
  HeadingFilter filter = filter_of_known_source();
  filter.depart(kBiasVariance);
  (void)filter.take_heading(3.1F, kVariance, {});
  filter.advance({0.1F, 5.0F}, 0.0F, kBiasVariance);
  EXPECT_EQ(filter.take_heading(3.2F - kTurn, kVariance, {}), Verdict::learnt);
  EXPECT_NEAR(filter.scale_factor(), 0.0F, 1e-4F);
}

TEST(HeadingFilter, TakesOneReferenceOfAStop) {
  HeadingFilter filter = filter_of_known_source();
  filter.depart(kBiasVariance);
  EXPECT_EQ(filter.take_heading(0.0F, kVariance, {}), Verdict::begun);
  EXPECT_EQ(filter.take_heading(0.0F, kVariance, {}), Verdict::too_soon);
  EXPECT_EQ(filter.take_heading(0.0F, 0.1F * kVariance, {}), Verdict::learnt) << "a better one";
}

/// Verifies SR-HEAD-08.
TEST(HeadingFilter, LearnsNothingWhileItsSourceMayBeAligning) {
  HeadingFilter filter{kParams};
  filter.depart(kBiasVariance);
  EXPECT_EQ(filter.take_heading(0.0F, kVariance, {}), Verdict::begun);
  for (int k = 0; k < 3; ++k) {
    filter.advance({1.0F, 70.0F}, 0.0F, kBiasVariance);
    EXPECT_EQ(filter.take_heading(0.5F, kVariance, {}), Verdict::begun);
  }
  EXPECT_FALSE(filter.has_learnt());
  filter.advance({0.01F, 70.0F}, 0.0F, kBiasVariance);
  EXPECT_EQ(filter.take_heading(0.51F, kVariance, {}), Verdict::learnt);
}

/// Drives a road with references of a second, changed by what is wrong with them.
template <class Wrong>
HeadingFilter driven(Wrong wrong) {
  HeadingFilter filter = filter_of_known_source();
  filter.depart(kBiasVariance);
  std::mt19937_64 random{9};
  std::normal_distribution<float> noise{0.0F, kSigma_rad};
  float heading = 0.0F;
  for (std::size_t k = 0; k < 1200; ++k) {
    const float turn = road(1200, 5)[k];
    heading += turn;
    filter.advance({turn, 1.0F}, 0.0F, kBiasVariance);
    (void)filter.take_heading(wrong(k, heading) + noise(random), kVariance, {});
  }
  return filter;
}

/// Verifies SR-HEAD-07.
TEST(HeadingFilter, NeverLearnsFromReferencesOfTheOtherSense) {
  const HeadingFilter filter = driven([](std::size_t, float heading) { return -heading; });
  EXPECT_TRUE(filter.disagrees());
  EXPECT_LT(std::abs(filter.scale_factor()), 2.0F * kParams.scale_factor);
}

/// Verifies SR-HEAD-07.
TEST(HeadingFilter, BeginsAnewAfterAJumpAndLearnsNothingFromIt) {
  const HeadingFilter filter =
      driven([](std::size_t k, float heading) { return heading + (k < 600 ? 0.0F : 0.6F); });
  EXPECT_FALSE(filter.disagrees()) << "ten minutes ago";
  EXPECT_LT(std::abs(filter.scale_factor()), 3e-3F);
  EXPECT_LT(std::abs(filter.bias_in_motion_rad_s()), 0.01F * kRadPerDeg);
}

TEST(HeadingFilter, LearnsThatReferencesStateTooLittle) {
  std::mt19937_64 random{10};
  std::normal_distribution<float> noise{0.0F, 10.0F * kSigma_rad};
  const HeadingFilter filter =
      driven([&](std::size_t, float heading) { return heading + noise(random); });
  EXPECT_NEAR(filter.state().judge.state().noise_factor, 100.0F, 50.0F);
}

TEST(HeadingFilter, LosesItsHeadingAndKeepsWhatItLearnt) {
  HeadingFilter filter = driven([](std::size_t, float heading) { return heading; });
  const float quality = filter.quality();
  EXPECT_GT(quality, 0.5F);
  filter.lose_heading();
  EXPECT_FALSE(filter.has_heading());
  EXPECT_EQ(filter.take_heading(2.0F, kVariance, {}), Verdict::begun);
  EXPECT_EQ(filter.quality(), quality);
}

TEST(HeadingFilter, GoesOnWithWhatAnotherRunLearnt) {
  const HeadingFilter learnt = driven([](std::size_t, float heading) { return heading; });
  HeadingFilter again{kParams};
  again.resume(learnt.state().learnt(), 0.0F);
  EXPECT_TRUE(again.has_learnt());
  EXPECT_FALSE(again.has_heading());
  EXPECT_EQ(again.scale_factor(), learnt.scale_factor());
  EXPECT_EQ(again.scale_factor_variance(), learnt.scale_factor_variance());
  EXPECT_EQ(again.offset_rad_s(), learnt.offset_rad_s());
  EXPECT_EQ(again.state().learnt(), learnt.state().learnt());
  EXPECT_TRUE(again.state().judge.is_new()) << "a receiver aligns after each switching-on";
}

TEST(HeadingFilter, KnowsNoMoreAfterYearsThanBeforeTheFirst) {
  const HeadingFilter learnt = driven([](std::size_t, float heading) { return heading; });
  HeadingFilter day{kParams};
  day.resume(learnt.state().learnt(), 24.0F * 3600.0F);
  const float grown = day.scale_factor_variance() - learnt.scale_factor_variance();
  EXPECT_NEAR(grown, 24.0F * 1e-8F, 1e-10F);
  HeadingFilter decades{kParams};
  decades.resume(learnt.state().learnt(), 1e10F);
  EXPECT_EQ(decades.quality(), 0.0F);
  EXPECT_EQ(decades.offset_variance_rad2_s2(), kParams.offset_rad_s * kParams.offset_rad_s);
}

TEST(HeadingFilter, TakesNothingUpWhereNoReferenceTaught) {
  const HeadingFilter fresh{kParams};
  HeadingFilter again{kParams};
  again.resume(fresh.state().learnt(), 10.0F);
  EXPECT_EQ(again.state(), fresh.state());
}

/// Variance of the scale factor that departures at other temperatures add.
float growth_at(HeadingFilter filter, const std::vector<float>& temperatures_k) {
  const float before = filter.scale_factor_variance();
  for (const float temperature_k : temperatures_k) filter.depart(kBiasVariance, temperature_k);
  return filter.scale_factor_variance() - before -
         1e-8F * static_cast<float>(temperatures_k.size());
}

TEST(HeadingFilter, IsLessSureAtAnotherTemperature) {
  HeadingFilter filter = filter_of_known_source();
  filter.depart(kBiasVariance, 300.0F);
  (void)filter.take_heading(0.0F, kVariance, {});
  filter.advance({1.0F, 10.0F}, 0.0F, kBiasVariance);
  ASSERT_EQ(filter.take_heading(1.0F, kVariance, {}), Verdict::learnt);
  constexpr float kPerK = HeadingFilter::Params{}.scale_factor_per_k;
  constexpr float kOfTenK = 10.0F * kPerK * 10.0F * kPerK;
  EXPECT_NEAR(growth_at(filter, {300.0F}), 0.0F, 0.01F * kOfTenK);
  EXPECT_NEAR(growth_at(filter, {310.0F}), kOfTenK, 0.01F * kOfTenK);
  EXPECT_NEAR(growth_at(filter, {302.0F, 304.0F, 306.0F, 308.0F, 310.0F}), kOfTenK,
              0.01F * kOfTenK);
  EXPECT_NEAR(growth_at(filter, {310.0F, 300.0F, 310.0F}), kOfTenK, 0.01F * kOfTenK);
  EXPECT_NEAR(growth_at(filter, {0.0F}), 0.0F, 0.01F * kOfTenK) << "no thermometer";
}

TEST(HeadingFilter, IsLessSureOfTheToleranceAwayFromItsTemperature) {
  HeadingFilter::Params params = kParams;
  params.scale_factor_per_k = 3e-4F;
  params.scale_factor_at_k = 298.0F;
  constexpr float kOfTwentyK = 20.0F * 3e-4F * 20.0F * 3e-4F;
  EXPECT_NEAR(growth_at(HeadingFilter{params}, {318.0F}), kOfTwentyK, 0.01F * kOfTwentyK);
  EXPECT_NEAR(growth_at(HeadingFilter{params}, {298.0F}), 0.0F, 0.01F * kOfTwentyK);
  EXPECT_NEAR(growth_at(HeadingFilter{params}, {0.0F}), 0.0F, 0.01F * kOfTwentyK);
}

/// Verifies SR-SNAP-10.
TEST(LearntMotion, IsRefusedWhereItIsImpossible) {
  const LearntMotion learnt =
      driven([](std::size_t, float heading) { return heading; }).state().learnt();
  EXPECT_TRUE(learnt.is_possible());
  const auto is_possible = [&](auto member, auto value) {
    LearntMotion other = learnt;
    other.*member = value;
    return other.is_possible();
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(is_possible(&LearntMotion::scale_factor, kNan));
  EXPECT_FALSE(is_possible(&LearntMotion::scale_factor, -0.6F));
  EXPECT_FALSE(is_possible(&LearntMotion::scale_variance, -1e-9F));
  EXPECT_FALSE(is_possible(&LearntMotion::covariance_rad_s, 1.0F));
  EXPECT_FALSE(is_possible(&LearntMotion::between_drives_weight, 0.0F));
  EXPECT_FALSE(is_possible(&LearntMotion::noise_factor, 0.0F));
  EXPECT_FALSE(is_possible(&LearntMotion::drives, learnt.references + 1));
}

TEST(HeadingFilter, RefusesAStateThatIsImpossible) {
  const HeadingFilter filter = driven([](std::size_t, float heading) { return heading; });
  EXPECT_TRUE(filter.state().is_possible());
  HeadingFilter::State state = filter.state();
  state.covariance(HeadingFilter::kScale, HeadingFilter::kScale) = -1.0F;
  EXPECT_FALSE(state.is_possible());
  state = filter.state();
  state.x[HeadingFilter::kScale] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(state.is_possible());
}

TEST(RecentTurn, IsTheIntegralSinceATimeThatLiesBack) {
  RecentTurn recent;
  for (int k = 0; k < 300; ++k) recent.add(0.01F * static_cast<float>(k), 0.01F);
  float expected = 0.0F;
  for (int k = 250; k < 300; ++k) expected += 0.01F * static_cast<float>(k);
  EXPECT_NEAR(recent.since(Duration::milliseconds(500)), expected, 0.01F * expected);
  EXPECT_EQ(recent.since({}), 0.0F);
  EXPECT_TRUE(std::isnan(recent.since(Duration::seconds(3))));
}

}  // namespace
}  // namespace zerorate::core
