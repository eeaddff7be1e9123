// Axes in C that no longer measure, and samples at a wrong rate.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>

#include "host_tests/unit/firmware/c_api/c_api_rig.hpp"

namespace zerorate::c_api {
namespace {

using testing::kBias;
using testing::kDriveSamples;
using testing::kStopSamples;
using testing::Moment;
using testing::moment;

constexpr float kCount_rad_s = 0.000153F;  // 0.00875 deg/s

/// A gyro that breaks in a vehicle.
struct BreakingGyro {
  zerorate_node node{};
  std::int64_t k = 0;
  zerorate_rate rate{};
  zerorate_result result = ZERORATE_OK;

  explicit BreakingGyro(const zerorate_config& config = zerorate_default_config()) {
    EXPECT_EQ(zerorate_init(&node, &front_gyro, &config), ZERORATE_OK);
  }

  void step(Moment now) {
    for (float& one : now.measured.rate_rad_s) one = kCount_rad_s * std::round(one / kCount_rad_s);
    EXPECT_EQ(zerorate_zero_velocity(&node, now.measured.time_ns, now.stands), ZERORATE_OK);
    result = zerorate_sample(&node, &now.measured, &rate);
    ++k;
  }
  void drive_until(std::int64_t end) {
    while (k < end) step(moment(k));
  }
  /// @return samples until the fault was told; nothing: it was not
  template <class Break>
  std::optional<std::int64_t> break_for(std::int64_t samples, Break break_it) {
    std::optional<std::int64_t> first;
    const std::int64_t begin = k;
    while (k < begin + samples) {
      Moment now = moment(k);
      break_it(now, k - begin);
      step(now);
      if (result == ZERORATE_SENSOR_FAULT && !first) first = k - begin;
    }
    return first;
  }
  void expect_fault() const {
    EXPECT_EQ(result, ZERORATE_SENSOR_FAULT);
    EXPECT_TRUE(rate.health.sensor_fault);
    EXPECT_NE(rate.motion, ZERORATE_STILL);
    for (const float corrected : rate.corrected_rad_s) EXPECT_TRUE(std::isnan(corrected));
  }
};

/// Verifies SR-HEALTH-12.
TEST(CInterfaceOfALiveGyro, FindsNoFault) {
  BreakingGyro gyro;
  for (int i = 0; i < 3 * (kStopSamples + kDriveSamples); ++i) {
    gyro.step(moment(gyro.k));
    ASSERT_EQ(gyro.result, ZERORATE_OK) << i;
    ASSERT_FALSE(gyro.rate.health.sensor_fault || gyro.rate.health.sample_rate_off) << i;
  }
}

/// Verifies SR-LEARN-11, SR-HEALTH-09, SR-IF-05.
TEST(CInterfaceWithAFrozenAxis, SaysSoSoonAndLearnsNothing) {
  for (std::size_t axis = 0; axis < ZERORATE_AXES; ++axis) {
    BreakingGyro gyro;
    gyro.drive_until(kStopSamples / 2);
    // Far from the bias, so that learning from it would show.
    const auto freeze = [&](Moment& now, std::int64_t) {
      now.measured.rate_rad_s[axis] = kBias[axis] + 0.002F;
    };
    const auto first = gyro.break_for(kStopSamples / 2, freeze);
    EXPECT_LT(first.value_or(kStopSamples), 200) << axis;
    gyro.expect_fault();
    EXPECT_NEAR(gyro.rate.bias_rad_s[axis], kBias[axis], 4.0F * gyro.rate.sigma_rad_s[axis]);
  }
}

TEST(CInterfaceWithAFrozenAxis, GoesOnWhenItMeasuresAgain) {
  BreakingGyro gyro;
  gyro.drive_until(kStopSamples / 4);
  gyro.break_for(500, [](Moment& now, std::int64_t) { now.measured.rate_rad_s[1] = 0.0F; });
  gyro.expect_fault();
  gyro.drive_until(kStopSamples);
  EXPECT_EQ(gyro.result, ZERORATE_OK);
  EXPECT_FALSE(gyro.rate.health.sensor_fault);
  EXPECT_EQ(gyro.rate.motion, ZERORATE_STILL);
}

TEST(CInterfaceWithAnAxisThatFreezesInADrive, SaysSo) {
  BreakingGyro gyro;
  gyro.drive_until(kStopSamples);
  const auto first = gyro.break_for(
      kDriveSamples, [](Moment& now, std::int64_t) { now.measured.rate_rad_s[2] = 0.1F; });
  EXPECT_LT(first.value_or(kDriveSamples), 200);
  gyro.expect_fault();
}

/// Verifies SR-HEALTH-10.
TEST(CInterfaceOfZerosFromTheStart, SaysSoWhereTheCountIsKnown) {
  zerorate_config config = zerorate_default_config();
  config.count_rad_s = kCount_rad_s;
  BreakingGyro gyro{config};
  const auto first = gyro.break_for(kStopSamples, [](Moment& now, std::int64_t) {
    for (float& one : now.measured.rate_rad_s) one = 0.0F;
  });
  EXPECT_LE(first.value_or(kStopSamples), 1001);
  gyro.expect_fault();
}

/// Verifies SR-HEALTH-09.
TEST(CInterfaceWithARampOnAnAxis, SaysSo) {
  BreakingGyro gyro;
  gyro.drive_until(kStopSamples / 2);
  const auto first = gyro.break_for(1000, [](Moment& now, std::int64_t i) {
    now.measured.rate_rad_s[0] = 2.0F * kCount_rad_s * static_cast<float>(i);
  });
  EXPECT_LT(first.value_or(1000), 200);
}

/// Verifies SR-HEALTH-11.
TEST(CInterfaceWithAnAxisAtFullScale, SaysSoAfterTenSeconds) {
  BreakingGyro gyro;
  gyro.drive_until(kStopSamples);
  const auto first = gyro.break_for(kDriveSamples, [](Moment& now, std::int64_t) {
    now.measured.rate_rad_s[1] = 4.36F;
    now.measured.saturated_axes = 0b010;
  });
  EXPECT_NEAR(static_cast<double>(first.value_or(0)), 1000.0, 10.0);
}

/// Verifies SR-IF-02.
TEST(CInterfaceWithACountThatCannotBe, RefusesIt) {
  zerorate_node node{};
  for (const float count : {-1e-3F, std::nanf(""), 2e6F}) {
    zerorate_config config = zerorate_default_config();
    config.count_rad_s = count;
    EXPECT_EQ(zerorate_init(&node, &front_gyro, &config), ZERORATE_BAD_ARGUMENT) << count;
  }
}

/// Every second sample is lost; the stamps of the others are right.
/// Verifies SR-HEALTH-21.
TEST(CInterfaceWithHalfOfItsSamples, SaysSo) {
  BreakingGyro gyro;
  for (int i = 0; i < 1000; ++i, ++gyro.k) gyro.step(moment(gyro.k));
  EXPECT_TRUE(gyro.rate.health.sample_rate_off);
  EXPECT_EQ(gyro.result, ZERORATE_OK);
}

/// Refused samples are none of an axis: they do not end a repetition.
TEST(CInterfaceWithAFrozenAxis, SaysSoBetweenRefusedSamples) {
  BreakingGyro gyro;
  gyro.drive_until(kStopSamples / 2);
  const auto first = gyro.break_for(1000, [](Moment& now, std::int64_t i) {
    now.measured.rate_rad_s[0] = i % 2 == 0 ? 0.0F : std::nanf("");
  });
  EXPECT_LT(first.value_or(1000), 400);
}

}  // namespace
}  // namespace zerorate::c_api
