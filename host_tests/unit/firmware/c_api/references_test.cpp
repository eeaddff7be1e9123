// References of the heading by the C interface.

#include <gtest/gtest.h>
#include <zerorate_references.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "host_tests/unit/firmware/c_api/c_api_rig.hpp"

namespace zerorate::c_api {
namespace {

using testing::feed;
using testing::kDriveSamples;
using testing::kPeriod_s;
using testing::kStopSamples;
using testing::kTurn_rad_s;
using testing::moment;

constexpr float kSigma_rad = 0.002F;

zerorate_config config_with_up() {
  zerorate_config config = zerorate_default_config();
  config.up_axis = 3;
  return config;
}

/// A gyro whose scale factor is 1 % too much, with a reference at the begin of each stop.
class ScaledGyro : public ::testing::Test {
 protected:
  void SetUp() override {
    const zerorate_config config = config_with_up();
    ASSERT_EQ(zerorate_init(&node_, &front_gyro, &config), ZERORATE_OK);
  }
  /// Steps over the next sample.
  zerorate_rate step() {
    testing::Moment now = moment(k_++);
    if (!now.stands) {
      now.measured.rate_rad_s[2] += 0.01F * kTurn_rad_s;
      heading_rad_ += double{kTurn_rad_s} * double{kPeriod_s};
    }
    now_ns_ = now.measured.time_ns;
    return feed(node_, now);
  }
  /// A stop with a reference, and the drive after it.
  zerorate_rate stop_and_drive() {
    for (std::int64_t k = 0; k < kStopSamples; ++k) {
      step();
      if (k == kStopSamples / 2) last_ = refer();
    }
    zerorate_rate rate{};
    for (std::int64_t k = 0; k < kDriveSamples; ++k) rate = step();
    return rate;
  }
  zerorate_result refer() {
    const double wrapped = std::remainder(sense_ * heading_rad_, 2.0 * std::numbers::pi);
    return zerorate_heading_reference(&node_, now_ns_, static_cast<float>(wrapped), kSigma_rad);
  }
  zerorate_learnt_motion learnt() {
    zerorate_learnt_motion motion{};
    EXPECT_EQ(zerorate_get_learnt_motion(&node_, &motion), ZERORATE_OK);
    return motion;
  }

  zerorate_node node_{};
  std::int64_t k_ = 0;
  std::int64_t now_ns_ = 0;
  double heading_rad_ = 0.0;
  double sense_ = 1.0;  ///< -1: the references turn the other way
  zerorate_result last_ = ZERORATE_OK;
};

/// Verifies SR-HEAD-06.
TEST_F(ScaledGyro, IsCorrectedByHeadingsAtStops) {
  constexpr double kTurn_rad = double{kTurn_rad_s} * double{kPeriod_s} * double{kDriveSamples};
  const zerorate_rate first = stop_and_drive();
  EXPECT_NEAR(double{first.turn_rad[2]}, 1.01 * kTurn_rad, 0.01);
  zerorate_rate last{};
  for (int drive = 0; drive < 11; ++drive) last = stop_and_drive();
  EXPECT_EQ(last_, ZERORATE_OK);
  EXPECT_NEAR(double{last.turn_rad[2]}, kTurn_rad, 0.01);
  EXPECT_LT(last.turn_sigma_rad[2], 0.5F * first.turn_sigma_rad[2]);
  EXPECT_NEAR(last.corrected_rad_s[2], kTurn_rad_s, 0.01F);
  const zerorate_learnt_motion motion = learnt();
  EXPECT_NEAR(motion.scale_factor_error.value, 0.01F, 3.0F * motion.scale_factor_error.sigma);
  EXPECT_LT(motion.scale_factor_error.sigma, 0.002F);
  EXPECT_GT(motion.quality, 0.8F);
  EXPECT_TRUE(last.health.usable);
}

/// Verifies SR-SNAP-10.
TEST_F(ScaledGyro, GoesOnAfterThePowerWasOff) {
  for (int drive = 0; drive < 12; ++drive) stop_and_drive();
  const zerorate_learnt_motion before = learnt();
  EXPECT_GT(before.references, 0U);
  EXPECT_GT(before.drives, 0U);
  std::array<std::uint8_t, ZERORATE_SNAPSHOT_BYTES> record{};
  ASSERT_EQ(zerorate_save(&node_, 0, record.data(), record.size()), ZERORATE_OK);
  SetUp();
  EXPECT_EQ(learnt().quality, 0.0F);
  ASSERT_EQ(zerorate_restore(&node_, 60, record.data(), record.size()), ZERORATE_OK);
  const zerorate_learnt_motion after = learnt();
  EXPECT_EQ(after.references, before.references);
  EXPECT_EQ(after.drives, before.drives);
  EXPECT_EQ(after.scale_factor_error.value, before.scale_factor_error.value);
  EXPECT_GE(after.scale_factor_error.sigma, before.scale_factor_error.sigma);
  EXPECT_LT(after.scale_factor_error.sigma, 1.5F * before.scale_factor_error.sigma);
  EXPECT_TRUE(std::isinf(after.heading_rad.sigma));
}

TEST_F(ScaledGyro, IsCorrectedByTheErrorThatItsModelStates) {
  constexpr double kTurn_rad = double{kTurn_rad_s} * double{kPeriod_s} * double{kDriveSamples};
  const zerorate_rate raw = stop_and_drive();
  zerorate_model model = front_gyro;
  model.scale_factor_error[2] = 0.01F;
  const zerorate_config config = config_with_up();
  ASSERT_EQ(zerorate_init(&node_, &model, &config), ZERORATE_OK);
  k_ = 0;
  heading_rad_ = 0.0;
  const zerorate_rate corrected = stop_and_drive();
  // The noise is the same: its hundredth and that of the bias are left.
  EXPECT_NEAR(double{raw.turn_rad[2] - corrected.turn_rad[2]}, 0.01 * kTurn_rad, 1e-3);
}

TEST_F(ScaledGyro, SaysWhereItIsHeading) {
  EXPECT_TRUE(std::isinf(learnt().heading_rad.sigma));
  stop_and_drive();
  const zerorate_learnt_motion motion = learnt();
  const double error =
      std::remainder(double{motion.heading_rad.value} - heading_rad_, 2.0 * std::numbers::pi);
  EXPECT_LT(std::abs(error), 3.0 * double{motion.heading_rad.sigma});
  const zerorate_rate rate = step();
  const double of_rate =
      std::remainder(double{rate.heading_rad} - heading_rad_, 2.0 * std::numbers::pi);
  EXPECT_LT(std::abs(of_rate), 3.0 * double{rate.heading_sigma_rad});
  EXPECT_EQ(rate.vertical_rad_s, rate.corrected_rad_s[2]);
}

/// Verifies SR-HEALTH-25.
TEST_F(ScaledGyro, SaysThatReferencesOfTheOtherSenseDisagree) {
  zerorate_rate rate{};
  for (int drive = 0; drive < 4; ++drive) rate = stop_and_drive();
  EXPECT_FALSE(rate.health.reference_disagreement);
  EXPECT_TRUE(rate.health.usable);
  sense_ = -1.0;
  for (int drive = 0; drive < 8; ++drive) rate = stop_and_drive();
  EXPECT_TRUE(rate.health.reference_disagreement);
  EXPECT_FALSE(rate.health.usable);
}

/// Verifies SR-HEAD-09.
TEST_F(ScaledGyro, RefusesATimeThatIsNotRemembered) {
  EXPECT_EQ(refer(), ZERORATE_NOTHING_LEARNT);
  stop_and_drive();
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  EXPECT_EQ(zerorate_heading_reference(&node_, now_ns_ + kSecond_ns, 0.0F, kSigma_rad),
            ZERORATE_REFERENCE_TIME);
  EXPECT_EQ(zerorate_heading_reference(&node_, now_ns_ - 10 * kSecond_ns, 0.0F, kSigma_rad),
            ZERORATE_REFERENCE_TIME);
  EXPECT_EQ(zerorate_turn_reference(&node_, now_ns_ - 10 * kSecond_ns, now_ns_, 0.0F, kSigma_rad),
            ZERORATE_REFERENCE_TIME);
}

TEST_F(ScaledGyro, LearnsFromTheTurnOfAWholeDrive) {
  stop_and_drive();
  for (int k = 0; k < 300; ++k) step();
  const std::int64_t drive_ns = kDriveSamples * testing::kPeriod_ns;
  const float turned = static_cast<float>(heading_rad_);
  ASSERT_EQ(zerorate_turn_reference(&node_, now_ns_ - drive_ns - 10'000'000'000, now_ns_, turned,
                                    kSigma_rad),
            ZERORATE_OK);
  EXPECT_NEAR(learnt().scale_factor_error.value, 0.01F, 0.002F);
}

/// Verifies SR-HEAD-09.
TEST(References, NeedAnAxisThatPointsUp) {
  zerorate_node node{};
  zerorate_learnt_motion motion{};
  EXPECT_EQ(zerorate_heading_reference(&node, 0, 0.0F, 0.1F), ZERORATE_NOT_INITIALISED);
  const zerorate_config without = zerorate_default_config();
  ASSERT_EQ(zerorate_init(&node, &front_gyro, &without), ZERORATE_OK);
  const zerorate_rate rate = feed(node, moment(0));
  EXPECT_TRUE(std::isnan(rate.vertical_rad_s));
  EXPECT_TRUE(std::isinf(rate.heading_sigma_rad));
  EXPECT_EQ(zerorate_heading_reference(&node, 0, 0.0F, 0.1F), ZERORATE_BAD_ARGUMENT);
  EXPECT_EQ(zerorate_turn_reference(&node, 0, 1, 0.0F, 0.1F), ZERORATE_BAD_ARGUMENT);
  EXPECT_EQ(zerorate_get_learnt_motion(&node, &motion), ZERORATE_BAD_ARGUMENT);
}

/// Verifies SR-HEAD-09.
TEST(References, RefuseWhatIsNoAngleOrDeviation) {
  constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
  zerorate_node node{};
  const zerorate_config config = config_with_up();
  ASSERT_EQ(zerorate_init(&node, &front_gyro, &config), ZERORATE_OK);
  for (const float sigma : {0.0F, -1.0F, 2.0F, kNothing}) {
    EXPECT_EQ(zerorate_heading_reference(&node, 0, 0.0F, sigma), ZERORATE_BAD_ARGUMENT) << sigma;
  }
  EXPECT_EQ(zerorate_heading_reference(&node, 0, kNothing, 0.1F), ZERORATE_BAD_ARGUMENT);
  EXPECT_EQ(zerorate_turn_reference(&node, 5, 5, 0.0F, 0.1F), ZERORATE_BAD_ARGUMENT);
  EXPECT_EQ(zerorate_get_learnt_motion(&node, nullptr), ZERORATE_BAD_ARGUMENT);
}

}  // namespace
}  // namespace zerorate::c_api
