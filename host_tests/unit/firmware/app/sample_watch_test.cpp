#include "firmware/app/sample_watch.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::app {
namespace {

using core::Duration;
using Vehicle = VehicleState;

/// A gyro of three axes at 100 Hz, in deg/s.
struct WatchedAxes {
  double step = 0.00875;
  double sigma = 0.04;
  double model_sigma = sigma;
  std::array<double, 3> rates{0.35, -0.2, 0.12};
  std::array<std::optional<double>, 3> stuck{};
  Vehicle vehicle = Vehicle::stands;
  std::uint64_t seed = 1;

  SampleWatch<> watch{
      static_cast<float>(model_sigma * model_sigma) * core::kRadPerDeg * core::kRadPerDeg,
      Duration::milliseconds(10)};
  std::int64_t count = 0;

  std::uint8_t sample() {
    core::GyroSample sample;
    for (std::size_t i = 0; i < 3; ++i) {
      const random::RandomStream noise{seed, i};
      const double rate = stuck.at(i).value_or(rates.at(i) + sigma * noise.normal(count));
      const auto raw = static_cast<float>(step > 0.0 ? std::round(rate / step) : rate);
      const auto lsb = core::deg_per_s(static_cast<float>(step > 0.0 ? step : 1.0));
      sample.rate.at(i) = lsb * raw;
    }
    ++count;
    return watch.take(sample, vehicle);
  }
  /// @return the first sample at which an axis was at fault; nothing: none was
  std::optional<int> run(int samples) {
    std::optional<int> first;
    for (int i = 0; i < samples; ++i) {
      if (sample() != 0 && !first) first = i;
    }
    return first;
  }
};

constexpr int kMinute = 6000;

/// Verifies SR-HEALTH-12.
TEST(SampleWatchOfALiveGyro, FindsNoFault) {
  WatchedAxes gyro;
  EXPECT_FALSE(gyro.run(30 * kMinute));
  gyro.vehicle = Vehicle::drives;
  EXPECT_FALSE(gyro.run(30 * kMinute));
}

/// Verifies SR-HEALTH-09.
TEST(SampleWatchOfAFrozenAxis, FindsItWithinTwoSecondsAndNoOther) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    WatchedAxes gyro;
    ASSERT_FALSE(gyro.run(kMinute));
    gyro.stuck.at(axis) = 0.12;
    EXPECT_LT(gyro.run(kMinute).value_or(kMinute), 200);
    EXPECT_EQ(gyro.sample(), 1U << axis);
    gyro.stuck.at(axis).reset();
    gyro.sample();
    EXPECT_EQ(gyro.sample(), 0U);
  }
}

TEST(SampleWatchOfAFrozenAxis, FindsItFromTheFirstSampleOn) {
  WatchedAxes gyro;
  gyro.stuck[2] = 0.0;
  EXPECT_LT(gyro.run(kMinute).value_or(kMinute), 500);
  EXPECT_EQ(gyro.sample(), 0b100U);
}

/// Verifies SR-HEALTH-10.
TEST(SampleWatchOfZeros, FindsAllAxesWithinTenSeconds) {
  WatchedAxes known;
  known.watch.set_step(core::deg_per_s(0.00875F));
  known.stuck.fill(0.0);
  EXPECT_LE(known.run(kMinute).value_or(kMinute), 1000);
  EXPECT_EQ(known.sample(), 0b111U);
}

/// Where no sample has differed yet, nobody knows the step; the road tells.
TEST(SampleWatchOfZerosWithoutAStep, FindsAllAxesWhileItDrives) {
  WatchedAxes gyro;
  gyro.stuck.fill(0.0);
  EXPECT_FALSE(gyro.run(kMinute));
  gyro.vehicle = Vehicle::drives;
  (void)gyro.run(1);
  EXPECT_EQ(gyro.sample(), 0b111U);
}

TEST(SampleWatchOfAGyroThatFreezesInABend, FindsItWhileItDrives) {
  WatchedAxes gyro;
  ASSERT_FALSE(gyro.run(kMinute));
  gyro.vehicle = Vehicle::drives;
  gyro.rates[2] += 10.0;
  gyro.stuck[2] = 0.12;
  EXPECT_LT(gyro.run(2000).value_or(2000), 200);
}

/// Verifies SR-HEALTH-09.
TEST(SampleWatchOfARamp, FindsTheAxis) {
  WatchedAxes gyro;
  ASSERT_FALSE(gyro.run(kMinute));
  gyro.sigma = 0.0;
  std::optional<int> first;
  for (int i = 0; i < 300 && !first; ++i) {
    gyro.stuck[1] = -50.0 + 0.0175 * i;
    gyro.rates = {0.1 * (i % 7), 0.0, 0.1 * (i % 5)};
    if (gyro.sample() == 0b010U) first = i;
  }
  EXPECT_LT(first.value_or(300), 200);
}

/// Verifies SR-HEALTH-11.
TEST(SampleWatchOfAnAxisAtFullScale, FindsItAfterTenSeconds) {
  WatchedAxes gyro;
  ASSERT_FALSE(gyro.run(kMinute));
  core::GyroSample sample;
  int first = 0;
  for (int i = 0; i < 2000 && first == 0; ++i) {
    sample.rate = {core::deg_per_s(0.01F * static_cast<float>(i % 3)),
                   core::deg_per_s(250.0F + 0.01F * static_cast<float>(i % 2)),
                   {}};
    sample.rate[2] = core::deg_per_s(0.01F * static_cast<float>(i % 5));
    sample.saturated_axes = 0b010;
    if (gyro.watch.take(sample, Vehicle::drives) == 0b010U) first = i;
  }
  EXPECT_GE(first, 990);
  EXPECT_LE(first, 1010);
}

/// Steps far above the noise: constant samples are the rule. The biases wander over five steps in
/// an hour, so that each place between two counts is met at rest and while the vehicle drives.
/// Verifies SR-HEALTH-12.
TEST(SampleWatchOfACoarseQuietGyro, FindsNoFaultAtAnyBias) {
  for (const double model : {0.2, 0.5, 1.0}) {
    WatchedAxes gyro{.step = 0.061, .sigma = 0.2 * 0.061, .model_sigma = model * 0.061};
    const std::array<double, 3> begin = gyro.rates;
    const int hour = 60 * kMinute;
    for (int i = 0; i < hour; ++i) {
      const bool drives = i % (10 * kMinute) > 5 * kMinute;
      gyro.vehicle = drives ? Vehicle::drives : Vehicle::stands;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto place = static_cast<double>(axis + 1) / 3.0;
        gyro.rates.at(axis) = begin.at(axis) + 5.0 * 0.061 * place * i / hour;
      }
      // Bends of 15 deg/s, of which 1 % reaches the level axes.
      const double bend = drives ? 15.0 * std::sin(i * 2.0 * std::numbers::pi / 900.0) : 0.0;
      gyro.rates[2] += bend;
      gyro.rates[0] += 0.01 * bend;
      gyro.rates[1] -= 0.01 * bend;
      ASSERT_EQ(gyro.sample(), 0U) << "model " << model << " steps, sample " << i;
    }
  }
}

TEST(SampleWatchOfACoarseQuietGyro, FindsAnAxisThatDoesNotTurn) {
  WatchedAxes gyro{.step = 0.061, .sigma = 0.2 * 0.061};
  ASSERT_FALSE(gyro.run(10 * kMinute));
  gyro.vehicle = Vehicle::drives;
  gyro.stuck[2] = 0.12;
  std::optional<int> first;
  for (int i = 0; i < kMinute && !first; ++i) {
    gyro.rates[0] = 3.0 * std::sin(i * 0.05);
    gyro.rates[1] = 3.0 * std::cos(i * 0.07);
    if (gyro.sample() == 0b100U) first = i;
  }
  EXPECT_LT(first.value_or(kMinute), 1000);
}

/// A C program may hand over rates that no converter rounded.
TEST(SampleWatchOfRatesWithoutSteps, FindsAFrozenAxisAndNoOther) {
  WatchedAxes gyro{.step = 0.0};
  ASSERT_FALSE(gyro.run(10 * kMinute));
  gyro.stuck[0] = 0.35;
  EXPECT_LT(gyro.run(kMinute).value_or(kMinute), 200);
  EXPECT_EQ(gyro.sample(), 0b001U);
}

TEST(SampleWatchOfOneAxis, FindsItFrozen) {
  SampleWatch<1> watch{1e-6F, Duration::milliseconds(10)};
  const random::RandomStream noise{1, 0};
  core::GyroSample sample;
  for (int i = 0; i < kMinute; ++i) {
    sample.rate[0] = core::rad_per_s(1e-3F * static_cast<float>(noise.normal(i)));
    ASSERT_EQ(watch.take(sample, Vehicle::stands), 0U) << i;
  }
  for (int i = 0; i < 100; ++i) (void)watch.take(sample, Vehicle::stands);
  EXPECT_EQ(watch.take(sample, Vehicle::stands), 1U);
}

TEST(VehicleState, IsDrivingForASecondAfterAPulse) {
  const core::Instant now = core::Instant::from_ns(60'000'000'000);
  const core::Instant lately = now - Duration::milliseconds(900);
  const core::Instant before = now - Duration::seconds(9);
  EXPECT_EQ(vehicle_state(core::Motion::still, before, now), VehicleState::stands);
  EXPECT_EQ(vehicle_state(core::Motion::moving, lately, now), VehicleState::drives);
  EXPECT_EQ(vehicle_state(core::Motion::moving, before, now), VehicleState::unknown);
  EXPECT_EQ(vehicle_state(core::Motion::moving, std::nullopt, now), VehicleState::unknown);
}

}  // namespace
}  // namespace zerorate::app
