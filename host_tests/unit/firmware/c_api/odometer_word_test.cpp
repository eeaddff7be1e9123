// Words of the vehicle in C that end, come late, or are of another clock.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "firmware/c_api/rest_word.hpp"
#include "host_tests/unit/firmware/c_api/c_api_rig.hpp"

namespace zerorate::c_api {
namespace {

using testing::kBias;
using testing::kPeriod_ns;
using testing::kStopSamples;
using testing::Moment;
using testing::moment;

constexpr float kCurve_rad_s = 0.3F;
constexpr std::int64_t kSecond = 100;  // samples

zerorate_config by_word() {
  zerorate_config config = zerorate_default_config();
  config.standstill = ZERORATE_BY_WORD;
  return config;
}

/// Samples of one vehicle, with words as the test gives them.
struct Vehicle {
  zerorate_node node{};
  std::int64_t k = 0;

  explicit Vehicle(const zerorate_config& config = by_word()) {
    EXPECT_EQ(zerorate_init(&node, &front_gyro, &config), ZERORATE_OK);
  }
  [[nodiscard]] std::int64_t now_ns() const { return k * kPeriod_ns; }

  void say(bool stands) { EXPECT_EQ(zerorate_zero_velocity(&node, now_ns(), stands), ZERORATE_OK); }
  zerorate_rate sample(float turn_rad_s = 0.0F) {
    Moment now = moment(k);
    now.measured.rate_rad_s[2] = moment(k % kStopSamples).measured.rate_rad_s[2] + turn_rad_s;
    ++k;
    zerorate_rate rate{};
    EXPECT_EQ(zerorate_sample(&node, &now.measured, &rate), ZERORATE_OK);
    return rate;
  }
  /// Stands, with a word of rest each `every` samples.
  zerorate_rate stand(std::int64_t samples, std::int64_t every = 10) {
    zerorate_rate rate{};
    for (std::int64_t i = 0; i < samples; ++i) {
      if (i % every == 0) say(true);
      rate = sample();
    }
    return rate;
  }
  zerorate_rate turn(std::int64_t samples) {
    zerorate_rate rate{};
    for (std::int64_t i = 0; i < samples; ++i) rate = sample(kCurve_rad_s);
    return rate;
  }
};

zerorate_config pulses_alone() {
  return zerorate_default_config();
}

TEST(CInterfaceWithAWordTenTimesASecond, LearnsTheBias) {
  Vehicle vehicle;
  const zerorate_rate rate = vehicle.stand(kStopSamples);
  EXPECT_TRUE(rate.health.calibrated);
  EXPECT_FALSE(rate.health.odometer_fault);
  EXPECT_EQ(rate.motion, ZERORATE_STILL);
  EXPECT_NEAR(rate.bias_rad_s[2], kBias[2], 4.0F * rate.sigma_rad_s[2]);
}

/// Verifies SR-STILL-06, SR-HEALTH-07.
TEST(CInterfaceWhoseBusDies, LearnsNothingOfACurve) {
  Vehicle vehicle;
  vehicle.stand(kStopSamples);
  for (int second = 1; second <= 120; ++second) {
    const zerorate_rate rate = vehicle.turn(kSecond);
    ASSERT_NEAR(rate.bias_rad_s[2], kBias[2], 4.0F * rate.sigma_rad_s[2]) << second;
    ASSERT_TRUE(rate.health.odometer_fault) << second;
    ASSERT_EQ(rate.motion, ZERORATE_MOVING) << second;
  }
}

// Where nothing was said of words, they are awaited from the first one on.
/// Verifies SR-HEALTH-07, SR-HEALTH-23.
TEST(CInterfaceWhoseWordsEnd, LearnsNothingOfACurve) {
  Vehicle vehicle{zerorate_default_config()};
  vehicle.stand(kStopSamples);
  const zerorate_rate rate = vehicle.turn(120 * kSecond);
  EXPECT_NEAR(rate.bias_rad_s[2], kBias[2], 4.0F * rate.sigma_rad_s[2]);
  EXPECT_TRUE(rate.health.usable);
  EXPECT_TRUE(rate.health.odometer_fault);
}

/// Verifies SR-STILL-06.
TEST(CInterfaceSwitchedOnWithADeadBus, LearnsNothingAndSaysSo) {
  Vehicle vehicle;
  EXPECT_FALSE(vehicle.turn(kSecond).health.odometer_fault);
  const zerorate_rate rate = vehicle.turn(60 * kSecond);
  EXPECT_FALSE(rate.health.calibrated);
  EXPECT_TRUE(rate.health.odometer_fault);
  EXPECT_EQ(rate.motion, ZERORATE_MOVING);
}

TEST(CInterfaceWhoseBusComesBack, LearnsTheNextStop) {
  Vehicle vehicle;
  vehicle.turn(60 * kSecond);
  EXPECT_TRUE(vehicle.stand(kStopSamples).health.calibrated);
}

/// Two seconds without a word are longer than the settle time.
TEST(CInterfaceToldOfMotionEveryTwoSeconds, CountsItAsMoving) {
  zerorate_config config = zerorate_default_config();
  config.word_timeout_ns = 3'000'000'000;
  Vehicle vehicle{config};
  for (int word = 0; word < 30; ++word) {
    vehicle.say(false);
    const zerorate_rate rate = vehicle.turn(2 * kSecond);
    ASSERT_EQ(rate.motion, ZERORATE_MOVING) << word;
    ASSERT_FALSE(rate.health.odometer_fault) << word;
  }
}

/// Verifies SR-STILL-07.
TEST(CInterfaceWithAWordOfAnotherClock, TakesItForNone) {
  for (const std::int64_t offset_ns : {-10'000'000'000, 10'000'000'000}) {
    Vehicle vehicle;
    vehicle.k = 60 * kSecond;
    zerorate_rate rate{};
    for (std::int64_t i = 0; i < 30 * kSecond; ++i) {
      const zerorate_result said =
          zerorate_zero_velocity(&vehicle.node, vehicle.now_ns() + offset_ns, true);
      ASSERT_EQ(said, i > 0 && offset_ns < 0 ? ZERORATE_CLOCK_WENT_BACK : ZERORATE_OK) << i;
      rate = vehicle.sample(kCurve_rad_s);
    }
    EXPECT_FALSE(rate.health.calibrated) << offset_ns;
    EXPECT_TRUE(rate.health.odometer_fault) << offset_ns;
  }
}

TEST(CInterfaceWithPulsesButNoWord, LearnsOnlyIfItIsToldSo) {
  Vehicle unaware;
  Vehicle aware{pulses_alone()};
  zerorate_rate unlearnt{};
  zerorate_rate learnt{};
  for (std::int64_t i = 0; i < kStopSamples; ++i) {
    unlearnt = unaware.sample();
    learnt = aware.sample();
  }
  EXPECT_FALSE(unlearnt.health.calibrated);
  EXPECT_TRUE(unlearnt.health.odometer_fault);
  EXPECT_TRUE(learnt.health.calibrated);
  EXPECT_FALSE(learnt.health.odometer_fault);
}

/// Verifies SR-STILL-08.
TEST(CInterfaceGivenAPulse, WaitsForTheNextWordOfRest) {
  Vehicle vehicle;
  vehicle.stand(kStopSamples, 1);
  ASSERT_EQ(zerorate_pulse(&vehicle.node, vehicle.now_ns()), ZERORATE_OK);
  EXPECT_EQ(vehicle.sample().motion, ZERORATE_MOVING);
  vehicle.say(true);
  vehicle.stand(20 * kSecond);
  EXPECT_EQ(vehicle.sample().motion, ZERORATE_STILL);
}

TEST(CInterfaceByTheGyroAlone, AsksForNoWord) {
  zerorate_config config = zerorate_default_config();
  config.standstill = ZERORATE_BY_GYRO;
  Vehicle vehicle{config};
  zerorate_rate rate{};
  for (std::int64_t i = 0; i < kStopSamples; ++i) rate = vehicle.sample();
  EXPECT_TRUE(rate.health.calibrated);
  EXPECT_FALSE(rate.health.odometer_fault);
}

/// Microseconds of 32 bits: 4,295 s.
/// Verifies SR-IF-05, SR-IF-07.
TEST(CInterfaceWhoseClockWraps, SaysSoAndGivesNoRate) {
  constexpr std::int64_t kWrap_ns = (std::int64_t{1} << 32) * 1000;
  Vehicle vehicle;
  vehicle.k = kWrap_ns / kPeriod_ns - kStopSamples;
  const zerorate_rate before = vehicle.stand(kStopSamples);
  ASSERT_TRUE(before.health.calibrated);
  zerorate_measurement wrapped = moment(vehicle.k).measured;
  wrapped.time_ns -= kWrap_ns;
  zerorate_rate rate{};
  EXPECT_EQ(zerorate_sample(&vehicle.node, &wrapped, &rate), ZERORATE_CLOCK_WENT_BACK);
  EXPECT_TRUE(rate.health.time_refused);
  EXPECT_TRUE(std::isnan(rate.corrected_rad_s[2]));
  EXPECT_EQ(zerorate_zero_velocity(&vehicle.node, 0, true), ZERORATE_CLOCK_WENT_BACK);
  EXPECT_EQ(zerorate_report_odometer_fault(&vehicle.node, 0), ZERORATE_CLOCK_WENT_BACK);
}

/// Pulses stamped by another clock than the samples.
/// Verifies SR-IF-07.
TEST(CInterfaceWhosePulsesAreOfAnotherClock, CountsThemAsMotion) {
  Vehicle vehicle{pulses_alone()};
  vehicle.k = 60 * kSecond;
  for (std::int64_t i = 0; i < kStopSamples; ++i) vehicle.sample();
  for (std::int64_t i = 0; i < 60 * kSecond; ++i) {
    ASSERT_EQ(zerorate_pulse(&vehicle.node, i), ZERORATE_CLOCK_WENT_BACK);
    const zerorate_rate rate = vehicle.sample(kCurve_rad_s);
    ASSERT_TRUE(rate.health.odometer_fault);
    ASSERT_NEAR(rate.bias_rad_s[2], kBias[2], 4.0F * rate.sigma_rad_s[2]) << i;
  }
}

/// Samples from the first word of rest until they are learnt from.
std::int64_t wait_of(const zerorate_config& config) {
  Vehicle vehicle{config};
  vehicle.say(false);
  vehicle.sample();
  while (vehicle.k < kStopSamples && vehicle.stand(1).motion != ZERORATE_STILL) {
  }
  return vehicle.k;
}

/// Verifies SR-STILL-09.
TEST(CInterfaceToldOfDeadBandAndLatency, HoldsBackLongerByThem) {
  const zerorate_config config = zerorate_default_config();
  zerorate_config late = config;
  late.odometer_dead_band_mps = 1.0F;
  late.odometer_latency_ns = 300'000'000;
  EXPECT_EQ(wait_of(late), wait_of(config) + 130);
}

/// Verifies SR-IF-02.
TEST(CInterfaceWithLimitsThatCannotBe, RefusesThem) {
  zerorate_node node{};
  for (const std::int64_t time_ns : {std::int64_t{-1}, std::int64_t{3'600'000'000'001}}) {
    zerorate_config config = zerorate_default_config();
    config.word_timeout_ns = time_ns;
    EXPECT_EQ(zerorate_init(&node, &front_gyro, &config), ZERORATE_BAD_TIMES) << time_ns;
    config = zerorate_default_config();
    config.odometer_latency_ns = time_ns;
    EXPECT_EQ(zerorate_init(&node, &front_gyro, &config), ZERORATE_BAD_TIMES) << time_ns;
  }
  zerorate_config forgotten = zerorate_default_config();
  forgotten.word_timeout_ns = 0;
  EXPECT_EQ(zerorate_init(&node, &front_gyro, &forgotten), ZERORATE_BAD_TIMES);
  for (const float speed : {-0.1F, 10.1F, std::numeric_limits<float>::quiet_NaN()}) {
    zerorate_config config = zerorate_default_config();
    config.odometer_dead_band_mps = speed;
    EXPECT_EQ(zerorate_init(&node, &front_gyro, &config), ZERORATE_BAD_ARGUMENT) << speed;
  }
}

TEST(RestWordThatComesLate, DoesNotReplaceTheNewest) {
  const auto at = [](std::int64_t ms) { return core::Instant::from_ns(ms * 1'000'000); };
  RestWord word{core::Duration::seconds(2), true};
  word.hear(at(5000), false);
  word.hear(at(4500), true);
  EXPECT_EQ(word.at(at(5000)), RestWord::Verdict::motion);
  word.hear(at(1000), true);  // its clock went back
  EXPECT_EQ(word.at(at(5000)), RestWord::Verdict::silence);
  EXPECT_EQ(word.at(at(1500)), RestWord::Verdict::rest);
}

}  // namespace
}  // namespace zerorate::c_api
