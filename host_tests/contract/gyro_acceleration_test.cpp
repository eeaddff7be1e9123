/// @file
/// Promises of drivers/common about the acceleration that a sample carries, for every chip with an
/// accelerometer, in both modes.

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <random>
#include <vector>

#include "host_tests/contract/any_gyro.hpp"

namespace zerorate::contract {
namespace {

using core::deg_per_s;
using core::GyroSample;
using core::standard_gravity;

constexpr Rates kBend{deg_per_s(10.0F), deg_per_s(-20.0F), deg_per_s(30.0F)};

Force in_g(float x, float y, float z) {
  return {standard_gravity(x), standard_gravity(y), standard_gravity(z)};
}

class GyroAcceleration : public ::testing::TestWithParam<AnyGyro> {
 protected:
  /// Half an LSB, and the rounding of values up to the range on both ways.
  static float tolerance_g() {
    return 0.5F * GetParam().lsb_g + 4.0F * GetParam().range_g * 0x1p-24F;
  }

  static void expect_force(const GyroSample& sample, const Force& sent) {
    ASSERT_TRUE(sample.has_acceleration);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(sample.acceleration[axis].in(standard_gravity), sent[axis].in(standard_gravity),
                  tolerance_g());
    }
  }
  static void expect_bend(const GyroSample& sample) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(sample.rate[axis].in(deg_per_s), kBend[axis].in(deg_per_s),
                  0.51F * GetParam().lsb_dps);
    }
  }
};
INSTANTIATE_TEST_SUITE_P(Every, GyroAcceleration, ::testing::ValuesIn(gyros_with_acceleration()),
                         name_of);

TEST_P(GyroAcceleration, IsOneGUpwardsAtRest) {
  for (const auto& settings : kModes) {
    const auto rig = GetParam().rig(settings);
    ASSERT_TRUE(rig->start_and_settle());
    rig->sample(kBend);
    std::array<GyroSample, 4> out{};
    ASSERT_EQ(rig->read(out).value_or(0), 1U);
    expect_force(out[0], in_g(0.0F, 0.0F, 1.0F));
    expect_bend(out[0]);
  }
}

TEST_P(GyroAcceleration, FollowsEachAxisAndSignToHalfAnLsb) {
  for (const auto& settings : kModes) {
    const auto rig = GetParam().rig(settings);
    ASSERT_TRUE(rig->start_and_settle());
    std::mt19937 random{20261127};
    const float span_g = 0.99F * GetParam().range_g;
    std::uniform_real_distribution<float> force{-span_g, span_g};
    for (int i = 0; i < 200; ++i) {
      const Force sent = in_g(force(random), force(random), force(random));
      rig->set_specific_force(sent);
      rig->sample(kBend);
      std::array<GyroSample, 4> out{};
      ASSERT_EQ(rig->read(out).value_or(0), 1U);
      expect_force(out[0], sent);
    }
  }
}

TEST_P(GyroAcceleration, StaysWithItsSampleInABatch) {
  if (GetParam().fifo_capacity == 0) GTEST_SKIP() << "no FIFO";
  const auto rig = GetParam().rig(kFifo);
  ASSERT_TRUE(rig->start_and_settle());
  const auto force = [](int i) { return in_g(0.01F * static_cast<float>(i), -0.5F, 1.0F); };
  for (int i = 0; i < 30; ++i) {
    rig->set_specific_force(force(i));
    rig->sample({deg_per_s(static_cast<float>(i)), {}, {}});
  }
  const std::vector<GyroSample> all = rig->read_all();
  ASSERT_EQ(all.size(), 30U);
  for (int i = 0; i < 30; ++i) {
    const GyroSample& sample = all[static_cast<std::size_t>(i)];
    EXPECT_NEAR(sample.rate[0].in(deg_per_s), static_cast<float>(i), 0.005F);
    EXPECT_EQ(sample.time, rig->clock().now() - rig->sample_period() * (29 - i));
    expect_force(sample, force(i));
  }
}

TEST_P(GyroAcceleration, IsInvalidWhereAnAxisIsSaturated) {
  for (const auto& settings : kModes) {
    const auto rig = GetParam().rig(settings);
    ASSERT_TRUE(rig->start_and_settle());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const float beyond_g : {1.5F, -1.5F}) {
        Force force = in_g(0.1F, 0.2F, 0.3F);
        force[axis] = standard_gravity(beyond_g * GetParam().range_g);
        rig->set_specific_force(force);
        rig->sample(kBend);
        rig->set_specific_force(in_g(0.1F, 0.2F, 0.3F));
        rig->sample(kBend);
        const std::vector<GyroSample> all = rig->read_all();
        ASSERT_GE(all.size(), 1U);  // the newest, where there is no FIFO
        expect_force(all.back(), in_g(0.1F, 0.2F, 0.3F));
        if (all.size() == 2) {
          EXPECT_FALSE(all[0].has_acceleration);
          EXPECT_EQ(all[0].saturated_axes, 0) << "the gyro is not saturated";
          expect_bend(all[0]);
        }
      }
    }
  }
}

TEST_P(GyroAcceleration, LeavesTheSamplesOfTheGyroBitForBit) {
  for (const auto& settings : kModes) {
    const auto rig = GetParam().rig(settings);
    const auto plain = GetParam().make_plain(settings, {});
    ASSERT_TRUE(rig->start_and_settle());
    ASSERT_TRUE(plain->start_and_settle());
    ASSERT_EQ(rig->sample_period(), plain->sample_period());
    const core::Duration apart = rig->clock().now() - plain->clock().now();
    std::mt19937 random{20261128};
    std::uniform_real_distribution<float> rate{-300.0F, 300.0F};
    for (int i = 0; i < 300; ++i) {
      const Rates sent{deg_per_s(rate(random)), deg_per_s(rate(random)), deg_per_s(rate(random))};
      rig->set_specific_force(in_g(rate(random), 0.0F, 1.0F));
      const auto temperature = core::Temperature::from_degc(0.1F * static_cast<float>(i));
      rig->sample(sent, temperature);
      plain->sample(sent, temperature);
      if (i % 7 != 0) continue;
      const std::vector<GyroSample> all = rig->read_all();
      const std::vector<GyroSample> expected = plain->read_all();
      ASSERT_EQ(all.size(), expected.size());
      for (std::size_t n = 0; n < all.size(); ++n) {
        EXPECT_EQ(all[n].time - apart, expected[n].time);
        EXPECT_EQ(all[n].has_temperature, expected[n].has_temperature);
        EXPECT_EQ(all[n].temperature, expected[n].temperature);
        EXPECT_EQ(all[n].saturated_axes, expected[n].saturated_axes);
        EXPECT_EQ(all[n].rate, expected[n].rate);
        EXPECT_FALSE(expected[n].has_acceleration);
      }
    }
  }
}

TEST_P(GyroAcceleration, MayBeLostWithoutLossOfTheRate) {
  if (!GetParam().can_lose_acceleration) GTEST_SKIP() << "a frame has both or neither";
  for (const int lost : {1, 2, 5}) {
    const auto rig = GetParam().rig(kFifo);
    ASSERT_TRUE(rig->start_and_settle());
    std::vector<GyroSample> all;
    for (int i = 0; i < 20; ++i) {
      if (i == 8) rig->lose_accelerations(lost);
      rig->sample({deg_per_s(static_cast<float>(i)), {}, {}});
      if (i % 10 != 9) continue;
      for (const GyroSample& sample : rig->read_all()) all.push_back(sample);
    }
    ASSERT_EQ(all.size(), 20U);
    core::Instant last{};
    int without = 0;
    for (int i = 0; i < 20; ++i) {
      const GyroSample& sample = all[static_cast<std::size_t>(i)];
      EXPECT_NEAR(sample.rate[0].in(deg_per_s), static_cast<float>(i), 0.005F);
      without += sample.has_acceleration ? 0 : 1;
      if (GetParam().acceleration_is_marked) {
        EXPECT_EQ(sample.has_acceleration, i < 8 || i >= 8 + lost) << i;
      }
      EXPECT_LE(sample.time, rig->clock().now());
      EXPECT_GT(sample.time, last);
      last = sample.time;
    }
    EXPECT_EQ(without, lost);
  }
}

TEST_P(GyroAcceleration, HasTheNoiseOfTheSensor) {
  const auto rig = GetParam().rig(kFifo);
  ASSERT_TRUE(rig->start_and_settle());
  constexpr double kSigma_g = 5e-3;
  constexpr int kSamples = 2000;
  rig->set_specific_force(in_g(0.2F, 0.0F, 1.0F), standard_gravity(static_cast<float>(kSigma_g)));
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    rig->sample({});
    std::array<GyroSample, 2> out{};
    ASSERT_EQ(rig->read(out).value_or(0), 1U);
    ASSERT_TRUE(out[0].has_acceleration);
    const double error = static_cast<double>(out[0].acceleration[0].in(standard_gravity)) - 0.2;
    sum += error;
    squares += error * error;
  }
  // Deviations of the mean and of the standard deviation of n normal values, five of each; rounding
  // to an LSB adds less than 1 %.
  EXPECT_NEAR(sum / kSamples, 0.0, 5.0 * kSigma_g / std::sqrt(kSamples));
  EXPECT_NEAR(std::sqrt(squares / kSamples), kSigma_g,
              kSigma_g * (5.0 / std::sqrt(2.0 * kSamples) + 0.01));
}

TEST_P(GyroAcceleration, OfThePowerUpNeverComesOut) {
  for (const auto& settings : kModes) {
    const auto rig = GetParam().rig(settings);
    ASSERT_TRUE(rig->start());
    int count = 0;
    for (int i = 0; i < 60; ++i) {
      rig->sample({});
      for (const GyroSample& sample : rig->read_all()) {
        expect_force(sample, in_g(0.0F, 0.0F, 1.0F));
        ++count;
      }
    }
    EXPECT_GT(count, 0);
  }
}

}  // namespace
}  // namespace zerorate::contract
