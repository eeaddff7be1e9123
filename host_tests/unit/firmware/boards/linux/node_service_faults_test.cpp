// Behaviour of the service under faults and over restarts.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hal/linux/i2c_dev.hpp"
#include "host_tests/unit/firmware/boards/linux/service_rig.hpp"

namespace zerorate::linux_node {
namespace {

using hal::testing::Fault;

TEST(NodeServiceWhoseGyroIsUnpluggedForFiveSeconds, Recovers) {
  ServiceRig rig;
  rig.run(1040);
  EXPECT_TRUE(rig.latest().health.calibrated);
  rig.hardware.rig.faults.inject({.first = rig.hardware.rig.faults.calls(),
                                  .calls = Fault::kForEver,
                                  .error = hal::BusError::not_present});
  rig.run(520);
  EXPECT_TRUE(rig.latest().health.sensor_fault);
  EXPECT_FALSE(rig.latest().has_rate());
  EXPECT_EQ(rig.latest().motion, core::Motion::moving);
  EXPECT_FALSE(rig.service->status().is_running);
  EXPECT_TRUE(was_logged("bus failed (not present)"));
  rig.hardware.rig.faults.clear();
  rig.run(312);
  EXPECT_FALSE(rig.latest().health.sensor_fault);
  EXPECT_TRUE(rig.latest().has_rate());
  EXPECT_NEAR(rig.latest().axes[1].corrected.in(core::deg_per_s), 0.0F, 1e-2F);
  EXPECT_EQ(rig.service->status().counters.starts, 2U);
}

/// Each transaction takes as long as the bus of Linux waits for a data line that is stuck.
TEST(NodeServiceWhoseBusBlocks, TellsTheSilenceFourTimesASecond) {
  ServiceRig rig;
  rig.run(520);
  auto& faults = rig.hardware.rig.faults;
  faults.inject(
      {.first = faults.calls(), .calls = Fault::kForEver, .error = hal::BusError::timeout});
  const core::Duration blocks = core::Duration::milliseconds(10) *
                                static_cast<std::int64_t>(hal::linux_os::I2cDevBus<>::kTimeLimit);
  std::size_t seen = faults.calls();
  std::uint32_t told = rig.service->latest()->sequence;
  core::Instant told_at = rig.hardware.now();
  core::Duration longest;
  const core::Instant end = told_at + core::Duration::seconds(30);
  while (rig.hardware.now() < end) {
    rig.service->measure();
    for (; seen < faults.calls(); ++seen) rig.hardware.rig.clock.advance(blocks);
    rig.service->publish_waiting();
    if (rig.service->latest()->sequence == told) continue;
    EXPECT_TRUE(rig.latest().health.sensor_fault);
    told = rig.service->latest()->sequence;
    longest = std::max(longest, rig.hardware.now() - told_at);
    told_at = rig.hardware.now();
  }
  EXPECT_LE(longest, core::Duration::milliseconds(400));
}

TEST(NodeServiceWhoseOdometerFails, NeverClaimsStandstillMeanwhile) {
  ServiceRig rig;
  rig.run(520);
  rig.hardware.odometer_fails = true;
  rig.run(208);
  EXPECT_EQ(rig.latest().motion, core::Motion::moving);
  EXPECT_TRUE(rig.latest().health.odometer_fault);
  EXPECT_TRUE(was_logged("odometer: cannot be read"));
  rig.hardware.odometer_fails = false;
  rig.run(520);
  EXPECT_EQ(rig.latest().motion, core::Motion::still);
  EXPECT_FALSE(rig.latest().health.odometer_fault);
}

struct NoiselessRig : ServiceRig {
  NoiselessRig() { hardware.sigma = {}; }
};
TEST(NodeServiceThatIsRestarted, GoesOnFromTheSavedState) {
  NoiselessRig rig;
  rig.run(900);
  const float bias = rig.latest().axes[0].bias.in(core::rad_per_s);
  rig.service->finish();

  SimulatedHardware hardware;
  hardware.rig.clock.advance_to(rig.hardware.now());
  NodeService again{rig.configuration, hardware, &rig.storage, kBoot, keep_line};
  EXPECT_TRUE(again.restore());
  again.measure();
  hardware.is_moving = true;  // nothing can be learnt
  for (int i = 0; i < 30; ++i) again.measure();
  again.publish_waiting();
  EXPECT_TRUE(again.latest()->message.health.calibrated);
  EXPECT_NEAR(again.latest()->message.axes[0].bias.in(core::rad_per_s), bias, 1e-6F);
}

TEST(NodeServiceAfterAnotherBoot, NeedsATurnOn) {
  ServiceRig rig;
  rig.configuration.node.model.turn_on_variance_rad2_s2 = std::numeric_limits<float>::infinity();
  rig.restart(kBoot);
  rig.run(2000);
  rig.service->finish();
  rig.restart(app::Session{'b'});
  EXPECT_FALSE(rig.service->restore());
  EXPECT_TRUE(was_logged("another boot, and the model has no [turn_on]"));
}

TEST(NodeServiceInTheSameBoot, SaysThatTheModelIsAnother) {
  ServiceRig rig;
  rig.configuration.node.model.turn_on_variance_rad2_s2 = std::numeric_limits<float>::infinity();
  rig.restart(kBoot);
  rig.run(2000);
  rig.service->finish();
  rig.configuration.node.model.white_variance_rad2_s2 *= 2.0F;
  rig.restart(kBoot);
  EXPECT_FALSE(rig.service->restore());
  EXPECT_TRUE(was_logged("saved with another model, and this one has no [turn_on]"));
}

TEST(NodeServiceAfterAnotherBoot, AddsTheTurnOn) {
  NoiselessRig rig;
  rig.configuration.node.model.turn_on_variance_rad2_s2 = 1e-6F;
  rig.restart(kBoot);
  rig.run(900);
  const app::RateMessage before = rig.latest();
  rig.service->finish();
  rig.restart(app::Session{'b'});
  EXPECT_TRUE(rig.service->restore());
  EXPECT_TRUE(was_logged("restored, aged by the time since it was saved"));
  rig.run(30);
  EXPECT_TRUE(rig.latest().health.calibrated);
  EXPECT_FLOAT_EQ(rig.latest().axes[0].bias.in(core::rad_per_s),
                  before.axes[0].bias.in(core::rad_per_s));
  EXPECT_GE(rig.latest().axes[0].sigma.in(core::rad_per_s), 0.9999e-3F);
  EXPECT_GT(rig.latest().axes[0].sigma, before.axes[0].sigma);
}

TEST(NodeServiceWithAnotherModel, GoesOnWithTheSavedBiasAlone) {
  ServiceRig rig;
  rig.configuration.node.model.turn_on_variance_rad2_s2 = 1e-6F;
  rig.restart(kBoot);
  rig.run(2000);
  rig.service->finish();
  Configuration changed = rig.configuration;
  changed.node.model.white_variance_rad2_s2 *= 2.0F;
  NodeService again{changed, rig.hardware, &rig.storage, kBoot, keep_line};
  EXPECT_TRUE(again.restore());
  EXPECT_TRUE(was_logged("restored, the bias alone, for the model has changed"));
}

TEST(NodeServiceWhoseStateCannotBeSaved, SaysSoAndGoesOn) {
  ServiceRig rig;
  std::filesystem::create_directory(rig.folder.path() / "state.0.new");  // in the way of both slots
  std::filesystem::create_directory(rig.folder.path() / "state.1.new");
  rig.run(2080);
  EXPECT_GE(rig.service->counters().save_errors, 1U);
  EXPECT_EQ(rig.service->counters().saves, 0U);
  EXPECT_TRUE(was_logged("state: not saved"));
  EXPECT_TRUE(rig.latest().has_rate());
}

}  // namespace
}  // namespace zerorate::linux_node
