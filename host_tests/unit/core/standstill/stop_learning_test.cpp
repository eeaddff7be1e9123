#include "core/standstill/stop_learning.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "core/base/units.hpp"

namespace zerorate::core {
namespace {

struct Tick : TickMean<3> {
  bool begins_stop = false;
  bool has_jumped = false;
  bool is_sway = false;
  constexpr bool operator==(const Tick&) const = default;
};
using Learning = StopLearning<Tick, 3, 16>;
constexpr Standstill::Params kStandstill{};
constexpr Standstill::Params kGyroAlone{.source = StandstillSource::gyro};
using White = WhiteLevel<3>;

constexpr Duration kTick = Duration::milliseconds(100);
constexpr Duration kSamplePeriod = Duration::milliseconds(10);

Instant at_ms(std::int64_t ms) {
  return Instant::from_ns(ms * 1'000'000);
}

/// One second to settle, half a second of hold-back, turns from 0.25 deg/s on; samples every 10 ms.
struct Vehicle {
  Learning learning{kStandstill, OdometerCheckParams{}, kTick, kSamplePeriod, 1e-12F};
  std::vector<std::pair<std::uint32_t, bool>> learnt{};  ///< ticks, and whether each begins a stop
  int sways = 0;                                         ///< means of swaying among them
  const White::Rates* predicted_rad_s = nullptr;  ///< predicted to 0.06 deg/s; nullptr: nothing is

  White white{1e-12F, {}, kTick, true};

  void sample(std::int64_t ms, float rate_rad_s) {
    const Instant at = at_ms(ms);
    const bool begins_tick = learning.begin_sample(at);
    if (begins_tick) {
      learning.close_tick({}, predicted_rad_s, 1e-6F, white, [](const TickMean<3>& mean) {
        return Tick{mean, false};
      });
      learning.enter_tick(at);
    }
    learning.add(at, begins_tick, {rate_rad_s, rate_rad_s, rate_rad_s}, [] { return true; });
    learning.confirm_at(at);
    take();
  }
  /// Takes what is certain.
  void take() {
    while (learning.confirmed() > 0) {
      const Tick tick = learning.take_confirmed();
      white.observe(tick);
      learnt.emplace_back(tick.tick, tick.begins_stop);
      sways += tick.is_sway ? 1 : 0;
    }
  }
  void samples(std::int64_t from_ms, std::int64_t to_ms, float rate_rad_s = 0.0F) {
    for (std::int64_t ms = from_ms; ms < to_ms; ms += 10) sample(ms, rate_rad_s);
  }
};

TEST(StopLearningAtAStop, ReleasesEachTickAfterTheHoldBack) {
  Vehicle vehicle;
  vehicle.samples(0, 3'000);
  // Settled from 1 s on; what ended a second before 2.99 s has been seen by three windows of half a
  // second, and is certain: ticks 10 to 18.
  ASSERT_EQ(vehicle.learnt.size(), 9U);
  for (std::size_t i = 0; i < vehicle.learnt.size(); ++i) {
    EXPECT_EQ(vehicle.learnt[i].first, 10U + i);
    EXPECT_EQ(vehicle.learnt[i].second, i == 0);
  }
  EXPECT_EQ(vehicle.learning.motion(), Motion::still);
}

/// Verifies SR-LEARN-03.
TEST(StopLearningAtAPulse, ReleasesCertainTicksDropsOthers) {
  Vehicle vehicle;
  vehicle.samples(0, 3'000);
  const auto before = vehicle.learnt.size();
  vehicle.learning.pulse(at_ms(3'150));
  vehicle.take();
  // Certain are ticks that end by 2.65 s: one or two more, and they belong to the same stop.
  EXPECT_GT(vehicle.learnt.size(), before);
  EXPECT_LE(vehicle.learnt.back().first, 26U);
  EXPECT_FALSE(vehicle.learnt.back().second);
  EXPECT_EQ(vehicle.learning.state().held.size(), 0U);
  // A second pulse: after a single one the silence must be twice that before it.
  vehicle.learning.pulse(at_ms(3'180));
  vehicle.samples(3'190, 6'000);
  EXPECT_GT(vehicle.learnt.back().first, 41U);
  std::size_t stops = 0;
  for (const auto& [tick, begins_stop] : vehicle.learnt) stops += begins_stop ? 1U : 0U;
  EXPECT_EQ(stops, 2U);
}

/// Verifies SR-STILL-05.
TEST(StopLearningWithoutTheOdometer, DropsAllThatIsHeld) {
  Vehicle vehicle;
  vehicle.samples(0, 3'000);
  const auto before = vehicle.learnt.size();
  vehicle.learning.report_odometer_fault(at_ms(3'000));
  vehicle.samples(3'000, 3'900);
  EXPECT_EQ(vehicle.learnt.size(), before);
  EXPECT_EQ(vehicle.learning.motion(), Motion::moving);
}

TEST(StopLearningOnATurnWithoutPulses, DropsAllAndIsNeverStill) {
  Vehicle vehicle;
  vehicle.samples(0, 3'000);
  const auto before = vehicle.learnt.size();
  vehicle.samples(3'000, 5'000, 0.1F);
  // The turn is told by the mean of half a second; what was certain until then had been released.
  EXPECT_LE(vehicle.learnt.size(), before + 6);
  EXPECT_EQ(vehicle.learning.state().held.size(), 0U);
  EXPECT_EQ(vehicle.learning.motion(), Motion::settling);
  EXPECT_TRUE(vehicle.learning.odometer_disagrees());
}

// From 4 s to 5 s the vehicle rolls and turns, slowly enough for the odometer check.
/// Verifies SR-STILL-10.
TEST(StopLearningOnMotionInsideAStop, LearnsBeforeAndAfterIt) {
  Vehicle vehicle;
  for (std::int64_t ms = 0; ms < 12'000; ms += 10) {
    const float noise = ms / 10 % 2 == 0 ? 1e-5F : -1e-5F;
    const float drift = ms / 500 % 2 == 0 ? 1e-6F : -1e-6F;
    const bool rolls = ms >= 4'000 && ms < 5'000;
    vehicle.sample(ms, noise + drift + (rolls ? 2e-3F : 0.0F));
  }
  std::vector<std::uint32_t> ticks;
  for (const auto& [tick, begins_stop] : vehicle.learnt) ticks.push_back(tick);
  EXPECT_EQ(ticks.front(), 10U);
  EXPECT_GE(ticks.back(), 107U);
  // The windows that see the motion begin at 3 s and end by 6.5 s.
  for (const std::uint32_t tick : ticks) EXPECT_TRUE(tick < 40U || tick >= 50U) << tick;
  EXPECT_GE(ticks.size(), 60U);
  EXPECT_FALSE(vehicle.learning.odometer_disagrees());
}

/// Verifies SR-STILL-11.
TEST(StopLearningWithoutAnOdometer, IsMovingWhileTheGyroIsNotCalm) {
  Vehicle vehicle{.learning = {kGyroAlone, OdometerCheckParams{}, kTick, kSamplePeriod, 1e-12F}};
  std::int64_t ms = 0;
  const auto run_until = [&](std::int64_t end_ms, float swing_rad_s) {
    for (; ms < end_ms; ms += 10) {
      const float noise = ms / 500 % 2 == 0 ? 1e-5F : -1e-5F;
      vehicle.sample(ms, noise + swing_rad_s * static_cast<float>(ms / 300 % 3));
      vehicle.learning.pulse(at_ms(ms));  // a wrong odometer
    }
  };
  run_until(10'000, 0.0F);
  EXPECT_EQ(vehicle.learning.motion(), Motion::still);
  const auto learnt = vehicle.learnt.size();
  EXPECT_GE(learnt, 75U);
  run_until(20'000, 2e-3F);
  EXPECT_EQ(vehicle.learning.motion(), Motion::moving);
  EXPECT_LE(vehicle.learnt.size(), learnt + 10);
  run_until(40'000, 0.0F);
  EXPECT_EQ(vehicle.learning.motion(), Motion::still);
  EXPECT_GE(vehicle.learnt.size(), learnt + 120);
  EXPECT_FALSE(vehicle.learning.odometer_disagrees());
}

TEST(StopLearningRestored, GoesOnAlike) {
  Vehicle whole;
  whole.samples(0, 2'730);
  Vehicle second;
  second.white.restore(whole.white.state());
  second.learning.restore(whole.learning.state(), second.white);
  EXPECT_TRUE(second.learning.state() == whole.learning.state());
  whole.learnt.clear();
  whole.samples(2'730, 4'000);
  second.samples(2'730, 4'000);
  EXPECT_EQ(whole.learnt, second.learnt);
  EXPECT_TRUE(second.learning.state() == whole.learning.state());
}

// A sensor three times as loud as its model, at 10 Hz: after a second its noise is known
// from a dozen differences only, by chance as half of what it is.
TEST(StopLearningOfASensorLouderThanItsModel, FindsNoTurnAtFirst) {
  constexpr float kLoud = 0.129F * kRadPerDeg;
  constexpr Duration kPeriod = Duration::milliseconds(100);
  std::mt19937_64 engine{7};
  std::normal_distribution<float> noise{0.0F, kLoud};
  for (int stop = 0; stop < 20'000; ++stop) {
    Learning learning{kStandstill, OdometerCheckParams{}, Duration::milliseconds(500), kPeriod,
                      kLoud * kLoud / 9.0F};
    White white{kLoud * kLoud / 9.0F, {}, Duration::milliseconds(500), true};
    Instant at = at_ms(0);
    for (int sample = 0; sample < 80; ++sample, at = at + kPeriod) {
      const bool begins_tick = learning.begin_sample(at);
      if (begins_tick) {
        learning.close_tick({}, nullptr, 0.0F, white, [](const TickMean<3>& mean) {
          return Tick{mean, false};
        });
        learning.enter_tick(at);
      }
      learning.add(at, begins_tick, {noise(engine), noise(engine), noise(engine)},
                   [] { return true; });
      learning.confirm_at(at);
      while (learning.confirmed() > 0) white.observe(learning.take_confirmed());
      ASSERT_FALSE(learning.odometer_disagrees()) << "stop " << stop << ", sample " << sample;
    }
  }
}

/// Number of means that a minute of swaying by 2 deg/s about a rate teaches, where a bias of zero
/// is predicted to 0.06 deg/s.
int lessons_of_swaying(float about_rad_s) {
  const White::Rates predicted{};
  Vehicle vehicle{.predicted_rad_s = &predicted};
  for (std::int64_t ms = 0; ms < 60'000; ms += 10) {
    const float phase = 2.0F * 3.14159265F * static_cast<float>(ms % 3'000) / 3'000.0F;
    vehicle.sample(ms, about_rad_s + 2.0F * kRadPerDeg * std::sin(phase));
  }
  return vehicle.sways;
}

TEST(StopLearningOfASwayingVehicle, TakesAMeanNearThePrediction) {
  EXPECT_EQ(lessons_of_swaying(0.0F), 1);
  EXPECT_EQ(lessons_of_swaying(1.0F * kRadPerDeg), 0);
}

}  // namespace
}  // namespace zerorate::core
