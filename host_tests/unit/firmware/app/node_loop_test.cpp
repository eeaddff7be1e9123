#include "firmware/app/node_loop.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/lsm6dso/registers.hpp"
#include "host_tests/support/allocation_counter.hpp"
#include "host_tests/unit/firmware/app/loop_rig.hpp"

namespace zerorate::app {
namespace {

using core::Duration;
using drivers::DriverErrorCode;
using hal::testing::Fault;

using testing::kMillisecond;
using testing::LoopRig;

TEST(NodeLoopWithHealthyHardware, PublishesEverySample) {
  LoopRig rig;
  EXPECT_FALSE(rig.loop.is_running());
  rig.start();
  EXPECT_TRUE(rig.loop.is_running());
  const std::uint32_t samples_before = rig.counters().samples;
  rig.samples(1000);
  EXPECT_EQ(rig.published.messages.size(), 1000U);
  EXPECT_EQ(rig.counters().samples - samples_before, 1000U);
  EXPECT_EQ(rig.counters().starts, 1U);
  EXPECT_EQ(rig.counters().start_errors, 0U);
  EXPECT_EQ(rig.counters().read_errors, 0U);
  EXPECT_EQ(rig.counters().configurations_lost, 0U);
  EXPECT_TRUE(rig.published.messages.back().health.calibrated);
}

TEST(NodeLoopPolledWithoutASample, PublishesNothing) {
  LoopRig rig;
  rig.start();
  rig.wait(Duration::milliseconds(50));
  EXPECT_TRUE(rig.published.messages.empty());
  EXPECT_EQ(rig.counters().read_errors, 0U);
}

TEST(NodeLoopPolledLate, StampsTheSampleWithItsDataReadyEdge) {
  LoopRig rig;
  rig.start();
  rig.hardware.sample({});
  const core::Instant edge = rig.hardware.clock.now();
  rig.hardware.clock.advance(Duration::milliseconds(4));
  rig.loop.poll();
  ASSERT_EQ(rig.published.messages.size(), 1U);
  EXPECT_EQ(rig.published.messages[0].time, edge);
}

/// Verifies SR-IF-18.
TEST(NodeLoopWhoseChipDoesNotAnswer, DoublesItsPausesToASecond) {
  LoopRig rig;
  rig.break_bus(Fault::kForEver);
  std::vector<std::int64_t> attempts_ms;
  for (std::int64_t ms = 0; ms < 6'000; ++ms) {
    const std::uint32_t before = rig.counters().start_errors;
    rig.loop.poll();
    if (rig.counters().start_errors > before) attempts_ms.push_back(ms);
    rig.hardware.clock.advance(kMillisecond);
  }
  // 10, 20, 40, ... 640 ms, then 1 s.
  EXPECT_EQ(attempts_ms, (std::vector<std::int64_t>{0, 10, 30, 70, 150, 310, 630, 1270, 2270, 3270,
                                                    4270, 5270}));
  EXPECT_EQ(rig.counters().starts, 0U);
  EXPECT_EQ(rig.counters().last_error.code, DriverErrorCode::bus_failed);
  rig.hardware.faults.clear();
  rig.wait(Duration::milliseconds(1100));
  EXPECT_TRUE(rig.loop.is_running());
  EXPECT_EQ(rig.counters().starts, 1U);
}

/// Verifies SR-HEALTH-08.
TEST(NodeLoopWithoutSamples, ReportsFourTimesASecond) {
  LoopRig rig;
  rig.start();
  rig.samples(500);
  const float bias = rig.published.messages.back().axes[0].bias.in(core::rad_per_s);
  rig.published.messages.clear();
  rig.break_bus(Fault::kForEver);
  rig.wait(Duration::milliseconds(1100));
  ASSERT_EQ(rig.published.messages.size(), 4U);
  EXPECT_EQ(rig.counters().silences, 4U);
  for (const RateMessage& message : rig.published.messages) {
    EXPECT_TRUE(message.health.sensor_fault);
    EXPECT_FALSE(message.has_rate());
    EXPECT_EQ(message.motion, core::Motion::moving);
    EXPECT_TRUE(message.health.calibrated);
    EXPECT_EQ(message.axes[0].bias.in(core::rad_per_s), bias);
  }
  rig.hardware.faults.clear();
  rig.wait(Duration::seconds(1));
  rig.published.messages.clear();
  rig.samples(50);
  ASSERT_FALSE(rig.published.messages.empty());
  EXPECT_TRUE(rig.published.messages.back().has_rate());
  EXPECT_FALSE(rig.published.messages.back().health.sensor_fault);
}

/// Verifies SR-INT-01.
TEST(NodeLoopWhoseChipNeverAnswered, SaysThatItIsNotCalibrated) {
  LoopRig rig;
  rig.break_bus(Fault::kForEver);
  rig.wait(Duration::milliseconds(300));
  ASSERT_EQ(rig.published.messages.size(), 1U);
  EXPECT_TRUE(rig.published.messages[0].health.sensor_fault);
  EXPECT_FALSE(rig.published.messages[0].health.calibrated);
  EXPECT_FALSE(core::is_finite(rig.published.messages[0].axes[0].sigma.in(core::rad_per_s)));
}

/// Verifies SR-IF-18.
TEST(NodeLoopAfterABusError, StartsTheChipAgainAndGoesOn) {
  LoopRig rig;
  rig.start();
  rig.samples(500);
  rig.break_bus(1);
  rig.sample();
  EXPECT_FALSE(rig.loop.is_running());
  EXPECT_EQ(rig.counters().read_errors, 1U);
  EXPECT_EQ(rig.counters().last_error.code, DriverErrorCode::bus_failed);
  EXPECT_EQ(rig.counters().last_error.bus, hal::BusError::io);
  rig.wait(Duration::milliseconds(20));
  EXPECT_TRUE(rig.loop.is_running());
  EXPECT_EQ(rig.counters().starts, 2U);
  const std::size_t published = rig.published.messages.size();
  rig.samples(500);
  EXPECT_GT(rig.published.messages.size(), published + 480U);  // less the start-up time
  EXPECT_EQ(rig.counters().read_errors, 1U);
}

TEST(NodeLoopAfterASuccessfulRestart, BeginsItsPausesAnew) {
  LoopRig rig;
  rig.start();
  for (int fault = 0; fault < 8; ++fault) {
    rig.break_bus(1);
    rig.sample();
    EXPECT_FALSE(rig.loop.is_running());
    rig.wait(Duration::milliseconds(15));
    EXPECT_TRUE(rig.loop.is_running()) << fault;
    rig.samples(20);
  }
  EXPECT_EQ(rig.counters().starts, 9U);
}

/// Verifies SR-IF-17.
TEST(NodeLoopWhoseChipWasUpset, RestoresTheChangedRegister) {
  LoopRig rig;
  rig.start();
  rig.hardware.chip.upset(drivers::lsm6dso::kCtrl2G.address, 0x04);  // 500 deg/s instead of 250
  rig.samples(12);  // the table has eleven entries, one is verified with each sample
  EXPECT_EQ(rig.counters().configurations_lost, 1U);
  EXPECT_EQ(rig.counters().last_error.code, DriverErrorCode::configuration_lost);
  rig.wait(Duration::milliseconds(20));
  EXPECT_EQ(rig.counters().starts, 2U);
  rig.samples(20);
  rig.published.messages.clear();
  rig.hardware.sample({core::rad_per_s(0.5F), {}, {}});
  rig.loop.poll();
  ASSERT_EQ(rig.published.messages.size(), 1U);
  const float lsb = core::deg_per_s(8.75e-3F).in(core::rad_per_s);
  EXPECT_NEAR(rig.published.messages[0].axes[0].measured.in(core::rad_per_s), 0.5F, 0.51F * lsb);
}

TEST(NodeLoopWhoseChipLostItsSupply, StartsItAgainAndKeepsTheBias) {
  LoopRig rig;
  rig.start();
  rig.samples(2000);
  const auto before = rig.node.state();
  rig.hardware.chip.cycle_power();
  // A chip that is powered down raises no data-ready: the loop polls, nothing comes.
  rig.wait(Duration::milliseconds(500));
  rig.samples(1);
  rig.wait(Duration::milliseconds(50));
  rig.samples(100);
  EXPECT_TRUE(rig.loop.is_running());
  EXPECT_EQ(rig.counters().starts, 2U);
  EXPECT_GE(rig.node.measured_ticks(), before.ticks.measured_ticks);
  EXPECT_TRUE(rig.published.messages.back().health.calibrated);
}

TEST(NodeLoopWithAFifoPolledLate, PublishesAllThatWaitsInOnePoll) {
  LoopRig rig{{.mode = drivers::lsm6dso::Mode::fifo}};
  rig.start();
  for (int i = 0; i < 100; ++i) rig.hardware.sample({});
  rig.loop.poll();
  ASSERT_EQ(rig.published.messages.size(), 100U);
  for (std::size_t i = 1; i < 100; ++i) {
    EXPECT_EQ(rig.published.messages[i].time - rig.published.messages[i - 1].time,
              rig.hardware.driver.sample_period());
  }
}

TEST(NodeLoopWithAFifoThatOverran, CountsItAndReadsOn) {
  LoopRig rig{{.mode = drivers::lsm6dso::Mode::fifo}};
  rig.start();
  for (int i = 0; i < 600; ++i) rig.hardware.sample({});  // 512 fit
  rig.loop.poll();
  EXPECT_EQ(rig.counters().overruns, 1U);
  EXPECT_EQ(rig.counters().read_errors, 1U);
  EXPECT_EQ(rig.counters().last_error.code, DriverErrorCode::fifo_overrun);
  EXPECT_TRUE(rig.loop.is_running());
  EXPECT_EQ(rig.counters().starts, 1U);
  const std::uint32_t samples = rig.counters().samples;
  rig.wait(Duration::milliseconds(100));
  EXPECT_EQ(rig.counters().samples - samples, 512U);
}

TEST(NodeLoopWithPulses, HandsThemAllToTheNodeAndCountsThem) {
  LoopRig rig;
  rig.start();
  rig.samples(500);
  EXPECT_NE(rig.published.messages.back().motion, core::Motion::moving);
  for (int i = 0; i < 40; ++i) rig.odometer.working.pulse(rig.hardware.clock.now());  // 2.5 batches
  rig.sample();
  EXPECT_EQ(rig.counters().pulses, 40U);
  EXPECT_EQ(rig.counters().pulses_lost, 0U);
  EXPECT_EQ(rig.published.messages.back().motion, core::Motion::moving);
  EXPECT_FALSE(rig.published.messages.back().health.odometer_fault);
}

/// Verifies SR-HEALTH-06.
TEST(NodeLoopWithAnOverflowingOdometer, CountsTheLostPulses) {
  LoopRig rig;
  rig.start();
  rig.samples(500);
  for (int i = 0; i < 70; ++i) rig.odometer.working.pulse(rig.hardware.clock.now());  // 64 fit
  rig.sample();
  EXPECT_EQ(rig.counters().pulses, 64U);
  EXPECT_EQ(rig.counters().pulses_lost, 6U);
  EXPECT_TRUE(rig.published.messages.back().health.odometer_fault);
  EXPECT_EQ(rig.published.messages.back().motion, core::Motion::moving);
  EXPECT_EQ(rig.published.messages.back().odometer_pulses, 70U);
}

TEST(NodeLoop, PublishesTheTemperatureOfTheChip) {
  LoopRig rig;
  rig.start();
  for (int i = 0; i < 200; ++i) {
    rig.hardware.sample({}, core::Temperature::from_degc(40.5F));
    rig.loop.poll();
  }
  const std::optional<core::Temperature> told = rig.published.messages.back().temperature;
  ASSERT_TRUE(told.has_value());
  EXPECT_NEAR(told->degc(), 40.5F, 0.01F);
  rig.wait(Duration::seconds(1));
  EXPECT_FALSE(rig.published.messages.back().temperature.has_value()) << "there was no sample";
}

TEST(NodeLoopWithoutAnOdometer, PublishesNoPulses) {
  LoopRig rig;
  rig.params.standstill.source = core::StandstillSource::gyro;
  rig.start();
  rig.samples(10);
  EXPECT_FALSE(rig.published.messages.back().odometer_pulses.has_value());
}

/// Verifies SR-STILL-05.
TEST(NodeLoopWhoseOdometerFails, CountsAsMovingAndLearnsNothing) {
  LoopRig rig;
  rig.start();
  rig.samples(500);
  const std::uint32_t learnt = rig.node.measured_ticks();
  rig.odometer.fails = true;
  const std::uint32_t errors_before = rig.counters().odometer_errors;
  rig.samples(300);
  EXPECT_EQ(rig.counters().odometer_errors - errors_before, 300U);
  EXPECT_EQ(rig.node.measured_ticks(), learnt);
  EXPECT_EQ(rig.published.messages.back().motion, core::Motion::moving);
  EXPECT_TRUE(rig.published.messages.back().health.odometer_fault);
  rig.odometer.fails = false;
  rig.samples(500);
  EXPECT_GT(rig.node.measured_ticks(), learnt);
}

/// Verifies SR-TIME-05.
TEST(NodeLoopWhoseOdometerNeverEnds, GoesOnAndCountsAsMoving) {
  LoopRig rig;
  rig.start();
  rig.samples(500);
  const std::size_t published = rig.published.messages.size();
  rig.odometer.is_endless = true;
  rig.samples(10);
  EXPECT_EQ(rig.published.messages.size(), published + 10);
  EXPECT_EQ(rig.published.messages.back().motion, core::Motion::moving);
  EXPECT_TRUE(rig.published.messages.back().health.odometer_fault);
}

/// Verifies SR-MEM-01.
TEST(NodeLoopOverAWholeDrive, NeverAllocatesInNodeLoopAndDriver) {
  LoopRig rig;
  rig.start();
  const support::AllocationCounter all;
  std::size_t by_the_simulation = 0;
  for (int i = 0; i < 6000; ++i) {
    const bool moves = i >= 2000 && i < 4000;
    const support::AllocationCounter simulation;
    rig.hardware.sample(
        {core::rad_per_s((moves ? 0.3F : 0.01F) + 1e-3F * static_cast<float>(i % 7)),
         core::rad_per_s(1e-3F * static_cast<float>(i % 5)),
         core::rad_per_s(1e-3F * static_cast<float>(i % 3))});
    if (moves) rig.odometer.working.pulse(rig.hardware.clock.now());
    by_the_simulation += simulation.count();
    rig.loop.poll();
  }
  EXPECT_EQ(rig.published.messages.size(), 6000U);
  EXPECT_GT(rig.counters().pulses, 0U);
  EXPECT_EQ(all.count() - by_the_simulation, 0U);
}

}  // namespace
}  // namespace zerorate::app
