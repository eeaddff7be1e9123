// Faults of the gyro that the loop finds in its samples.

#include <gtest/gtest.h>

#include "host_tests/unit/firmware/app/loop_rig.hpp"

namespace zerorate::app {
namespace {

using core::Duration;
using drivers::DriverErrorCode;
using testing::LoopRig;

/// A vehicle that stood for half a minute, and turns with 10 deg/s while one axis is frozen.
TEST(NodeLoopWithAFrozenAxis, PublishesNoRateUntilItMeasuresAgain) {
  LoopRig rig;
  rig.start();
  rig.samples(3000);
  rig.stuck[0] = core::rad_per_s(0.01F);
  for (int i = 0; i < 300; ++i) {
    rig.odometer.working.pulse(rig.hardware.clock.now());
    rig.sample(0.17F);
  }
  rig.published.messages.clear();
  rig.samples(1000, 0.17F);
  ASSERT_FALSE(rig.published.messages.empty());
  for (const RateMessage& message : rig.published.messages) EXPECT_FALSE(message.has_rate());
  EXPECT_EQ(rig.counters().last_error.code, DriverErrorCode::frozen);
  EXPECT_EQ(rig.counters().last_error.reg, 0b001);
  EXPECT_GT(rig.counters().starts, 3U);
  EXPECT_LT(rig.counters().starts, 20U) << "the pauses double";
  rig.stuck[0].reset();
  rig.samples(300);
  EXPECT_TRUE(rig.published.messages.back().has_rate());
}

/// Stands for a second reader, or for edges of the wrong kind.
/// Verifies SR-HEALTH-21.
TEST(NodeLoopThatGetsHalfOfTheSamples, FlagsTheRateUntilAllCome) {
  LoopRig rig;
  rig.start();
  rig.samples(1000);
  EXPECT_FALSE(rig.published.messages.back().health.sample_rate_off);
  for (int i = 0; i < 1000; ++i) {
    rig.hardware.clock.advance(rig.hardware.driver.sample_period());
    rig.sample();
  }
  EXPECT_TRUE(rig.published.messages.back().health.sample_rate_off);
  EXPECT_TRUE(rig.published.messages.back().has_rate());
  EXPECT_NEAR(rig.loop.sample_rate().samples_per_second(), 52.0F, 1.0F);
  rig.samples(1000);
  EXPECT_FALSE(rig.published.messages.back().health.sample_rate_off);
}

/// Verifies SR-HEALTH-21.
TEST(NodeLoopWhoseChipRunsAtAnotherRate, FlagsTwiceTheSamples) {
  LoopRig rig{{.mode = drivers::lsm6dso::Mode::fifo}};
  rig.start();
  const Duration period = rig.hardware.driver.sample_period();
  const auto run = [&](int extra_every) {
    for (int i = 0; i < 3000; ++i) {
      const auto rate = core::rad_per_s(0.001F * static_cast<float>(i % 7));
      if (i % extra_every == 0) rig.hardware.chip.measure({rate, rate, rate}, {});
      rig.sample();
    }
    return rig.published.messages.back().health.sample_rate_off;
  };
  EXPECT_FALSE(run(10));
  EXPECT_TRUE(run(1));
  for (int i = 0; i < 3000; ++i) {
    rig.hardware.clock.advance(period / 10);
    rig.sample();
  }
  EXPECT_FALSE(rig.published.messages.back().health.sample_rate_off);
}

/// The chip answers, and its data-ready flag never rises: its oscillator stands still.
/// Verifies SR-HEALTH-08.
TEST(NodeLoopWhoseChipMeasuresNothing, StartsItAgainAndSaysWhy) {
  for (const auto mode : {drivers::lsm6dso::Mode::data_ready, drivers::lsm6dso::Mode::fifo}) {
    LoopRig rig{{.mode = mode}};
    rig.start();
    rig.samples(500);
    rig.wait(Duration::seconds(30));
    EXPECT_EQ(rig.counters().last_error.code, DriverErrorCode::no_new_samples);
    EXPECT_GE(rig.counters().starts, 8U);
    EXPECT_LE(rig.counters().starts, 20U);
    EXPECT_TRUE(rig.published.messages.back().health.sensor_fault);
    rig.wait(Duration::milliseconds(1500));
    rig.samples(500);
    EXPECT_TRUE(rig.published.messages.back().has_rate());
  }
}

/// One transfer of the temperature gives FF, or bytes of two conversions.
TEST(NodeLoopWithATornTemperature, WithholdsItUntilTheNextAgrees) {
  LoopRig rig;
  rig.start();
  const auto published_at = [&](float degc) {
    const auto rate = core::rad_per_s(0.001F * static_cast<float>(rig.counters().samples % 7));
    rig.hardware.sample({rate, rate, rate}, core::Temperature::from_degc(degc));
    rig.loop.poll();
    return rig.published.messages.back().temperature;
  };
  (void)published_at(40.0F);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(published_at(40.0F + 0.02F * static_cast<float>(i)));
  EXPECT_FALSE(published_at(25.0F));
  EXPECT_FALSE(published_at(40.3F));
  EXPECT_TRUE(published_at(40.3F));
  EXPECT_FALSE(published_at(41.3F)) << "one bit of the high byte";
  EXPECT_TRUE(published_at(41.3F)) << "it stays: the chip was warmed";
}

float sigma_of(const LoopRig& rig) {
  return rig.published.messages.back().axes[2].sigma.in(core::rad_per_s);
}

/// Parameters whose bias changes by 1e-3 rad/s while the power is off.
struct TurnOnRig : LoopRig {
  TurnOnRig() {
    params.model.turn_on_variance_rad2_s2 = 1e-6F;
    start();
    samples(3000);
    odometer.working.pulse(hardware.clock.now());
    samples(20);
  }
};

/// Verifies SR-INT-08.
TEST(NodeLoopWhoseChipLostItsPower, WidensTheInterval) {
  TurnOnRig rig;
  ASSERT_LT(sigma_of(rig), 1e-4F);
  rig.hardware.chip.cycle_power();
  rig.samples(100);
  EXPECT_GE(sigma_of(rig), 0.999e-3F);
  EXPECT_EQ(rig.counters().configurations_lost, 1U);
  EXPECT_EQ(rig.counters().starts, 2U);
  EXPECT_TRUE(rig.published.messages.back().health.calibrated);
  // The bias that it came back with is learnt.
  rig.samples(3000, 0.012F);
  const AxisRate& axis = rig.published.messages.back().axes[0];
  EXPECT_LT(axis.sigma.in(core::rad_per_s), 2e-4F);
  EXPECT_NEAR(axis.bias.in(core::rad_per_s), 0.012F, 5.0F * axis.sigma.in(core::rad_per_s));
}

/// The supply fails together with the bus, so that the loss shows only when the chip answers again.
/// Verifies SR-INT-08.
TEST(NodeLoopWhoseChipLostItsPower, FindsItBehindAFailureOfTheBus) {
  TurnOnRig rig;
  rig.break_bus(hal::testing::Fault::kForEver);
  rig.wait(Duration::seconds(3));
  rig.hardware.chip.cycle_power();
  rig.hardware.faults.clear();
  rig.wait(Duration::milliseconds(1100));
  rig.samples(100);
  EXPECT_GE(sigma_of(rig), 0.999e-3F);
}

TEST(NodeLoopAfterAFailureOfTheBusAlone, KeepsTheInterval) {
  TurnOnRig rig;
  rig.break_bus(hal::testing::Fault::kForEver);
  rig.wait(Duration::seconds(3));
  rig.hardware.faults.clear();
  rig.wait(Duration::milliseconds(1100));
  rig.samples(100);
  EXPECT_TRUE(rig.published.messages.back().has_rate());
  EXPECT_LT(sigma_of(rig), 1e-4F);
}

/// Verifies SR-INT-08.
TEST(NodeLoopWhoseModelKnowsNoTurnOn, TakesTheLargestBiasOfTheChip) {
  LoopRig rig;
  rig.params.model.largest_bias_rad_s = 0.05F;
  rig.start();
  rig.samples(3000);
  rig.hardware.chip.cycle_power();
  rig.samples(40);
  EXPECT_GE(sigma_of(rig), 0.0499F);
}

/// A drive of eight hours that nobody saw: the clock of the samples stands still meanwhile.
/// Verifies SR-INT-09.
TEST(NodeLoopOnAMachineThatSlept, AgesTheBiasByThatTime) {
  const auto sigma_after = [](Duration slept, bool has_lost_power) {
    TurnOnRig rig;
    const float before = sigma_of(rig);
    if (has_lost_power) rig.hardware.chip.cycle_power();
    rig.clock.asleep = rig.clock.asleep + slept;
    rig.samples(100);
    EXPECT_TRUE(rig.published.messages.back().has_rate());
    EXPECT_EQ(rig.counters().sleeps, slept > Duration{} ? 1U : 0U);
    return sigma_of(rig) / before;
  };
  const float awake = sigma_after({}, false);
  const float asleep = sigma_after(Duration::seconds(8 * 3600), false);
  EXPECT_GT(asleep, 1.2F * awake);
  EXPECT_GT(sigma_after(Duration::seconds(8 * 3600), true), 5.0F * asleep);
}

}  // namespace
}  // namespace zerorate::app
