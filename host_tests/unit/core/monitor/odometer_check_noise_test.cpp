// How loud a sensor is, and how often it is sampled, decides from when on a rate is a turn.

#include "core/monitor/odometer_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

#include "host_tests/unit/core/monitor/standing_vehicle.hpp"

namespace zerorate::core {
namespace {

// 2 deg/s rms at an idling engine's 22.5 Hz: what is left of it in a window is a sixth of that.
TEST(OdometerCheckInAShakingVehicle, JudgesByQuietWindows) {
  for (const int tick_ms : {100, 500}) {
    Check check = make_check({}, Duration::milliseconds(tick_ms));
    const int samples = tick_ms / 10;
    for (int tick = 0; tick < 10'000 / samples; ++tick) {
      float sum = 0.0F;
      for (int k = tick * samples; k < (tick + 1) * samples; ++k) {
        sum +=
            std::sqrt(2.0F) * 2.0F * std::sin(2.0F * 3.14159265F * 0.225F * static_cast<float>(k));
      }
      check.on_standing_tick(turning(sum / static_cast<float>(samples)),
                             static_cast<std::uint32_t>(samples), &kBias, kVariance);
      ASSERT_FALSE(check.disagrees()) << tick_ms << " ms, tick " << tick;
    }
  }
}

TEST(OdometerCheckGivenFewerSamples, JudgesByThoseThatCame) {
  for (const std::uint32_t samples : {38U, 36U, 26U, 25U}) {  // a full tick has 50
    Check check = make_check();
    for (int tick = 0; tick < 40; ++tick) check.on_standing_tick(kBias, samples, &kBias, kVariance);
    EXPECT_FALSE(check.disagrees()) << samples;
    check.on_standing_tick(turning(5.0F), samples, &kBias, kVariance);
    EXPECT_TRUE(check.turns()) << samples;
  }
}

TEST(OdometerCheckGivenATickThatLacksSamples, WaitsForHalfAWindow) {
  Check check = make_check();
  stand(check, kBias, 20);
  check.on_standing_tick(turning(5.0F), kSamples / 5, &kBias, kVariance);
  EXPECT_FALSE(check.disagrees());
  check.on_standing_tick(turning(5.0F), kSamples / 5, &kBias, kVariance);
  EXPECT_FALSE(check.disagrees());
  check.on_standing_tick(turning(5.0F), kSamples / 5, &kBias, kVariance);
  EXPECT_TRUE(check.turns());
}

// The white noise of a window decides, whatever the ticks are: 0.35 deg/s of a sample at 100 Hz
// allow 0.30 deg/s after half a second, and 0.25 deg/s after 0.75 s, against a level of 15 s.
TEST(OdometerCheckWhoseTickIsASample, HasTheLimitOfAWindow) {
  constexpr float kLoud = 0.35F * kRadPerDeg;
  for (const int tick_ms : {10, 20, 100, 500}) {
    Check check{{}, Duration::milliseconds(tick_ms), kSamplePeriod, kLoud * kLoud};
    const auto samples = static_cast<std::uint32_t>(tick_ms / 10);
    const auto run = [&](float dps, int ms) {
      for (int tick = 0; tick < ms / tick_ms; ++tick) {
        check.on_standing_tick(turning(dps), samples, &kBias, kVariance);
      }
    };
    run(0.0F, 20'000);
    run(0.2F, 6'000);
    EXPECT_FALSE(check.turns()) << tick_ms;
    run(0.0F, 20'000);
    run(0.3F, 6'000);
    EXPECT_TRUE(check.turns()) << tick_ms;
    run(0.0F, 20'000);
    EXPECT_FALSE(check.turns()) << tick_ms;
    run(1.5F, 1'000);
    EXPECT_TRUE(check.turns()) << tick_ms;
  }
}

// 5 s are less than a tick of 10 s: one tick, not for ever.
TEST(OdometerCheckWhoseTickIsLongerThanABend, AcceptsTwoTicks) {
  constexpr Duration kLong = Duration::seconds(10);
  Check check{{}, kLong, kSamplePeriod, kSigmaRadS * kSigmaRadS};
  constexpr std::uint32_t kMany = 1000;
  for (int tick = 0; tick < 10; ++tick) check.on_standing_tick(kBias, kMany, &kBias, kVariance);
  check.on_driving_tick(kBias);
  check.on_standing_tick(turning(0.5F), kMany, nullptr, 0.0F);
  EXPECT_TRUE(check.turns());
  check.on_standing_tick(turning(0.5F), kMany, nullptr, 0.0F);
  EXPECT_FALSE(check.turns());
}

TEST(OdometerCheckOfALoudSensor, AllowsForItsNoise) {
  // Noise of a sample. Against a level of 10 s, 6 sigma are 0.58 deg/s after 0.5 s, 0.31 after 2 s.
  constexpr float kLoud = 0.67F * kRadPerDeg;
  Check check{{}, kTick, kSamplePeriod, kLoud * kLoud};
  stand(check, kBias, 20);
  EXPECT_EQ(ticks_until(check, turning(0.28F), true), 1000);
  EXPECT_LE(ticks_until(check, turning(0.7F), true), 8);
  Check other{{}, kTick, kSamplePeriod, kLoud * kLoud};
  stand(other, kBias, 20);
  EXPECT_EQ(ticks_until(other, turning(1.5F), true), 1);
}

// The level of a stop that has just begun is as noisy as half a second. Stops of 20 s of an
// ADIS16405 at 10 Hz; at six standard deviations one window in 10^8 turns against it.
TEST(OdometerCheckOfALoudSensor, IsSilentInStopsAtRest) {
  constexpr float kLoud = 0.129F * kRadPerDeg;
  constexpr std::uint32_t kOfTick = 5;
  Check check{{}, kTick, Duration::milliseconds(100), kLoud * kLoud};
  std::mt19937_64 engine{5};
  std::normal_distribution<float> of_sample{0.0F, kLoud};
  std::normal_distribution<float> of_tick{0.0F, kLoud / std::sqrt(static_cast<float>(kOfTick))};
  const auto measured = [&](auto& noise) {
    return Rates{kBias[0] + noise(engine), kBias[1] + noise(engine), kBias[2] + noise(engine)};
  };
  for (int stop = 0; stop < 10'000; ++stop) {
    for (int tick = 0; tick < 20; ++tick) check.on_driving_tick(measured(of_sample));
    for (int tick = 0; tick < 40; ++tick) {
      check.on_standing_tick(measured(of_tick), kOfTick, &kBias, kVariance);
      ASSERT_FALSE(check.turns()) << "stop " << stop << ", tick " << tick;
    }
  }
}

}  // namespace
}  // namespace zerorate::core
