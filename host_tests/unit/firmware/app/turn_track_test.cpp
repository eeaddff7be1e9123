// The turn since departure as a node publishes it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "host_tests/unit/firmware/app/node_rig.hpp"

namespace zerorate::app {
namespace {

using testing::at_ms;
using testing::drive;
using testing::kBias;
using testing::node_params;
using testing::noisy_sample;
using testing::stand;

using testing::Node;

double turn_rad(const RateMessage& message, std::size_t axis) {
  return double{message.turn[axis].angle.in(core::rad)};
}
double sigma_rad(const RateMessage& message, std::size_t axis) {
  return double{message.turn[axis].sigma.in(core::rad)};
}

/// Verifies SR-HEAD-01.
TEST(TurnOfADrive, IsPublishedForEachAxisWithItsInterval) {
  const auto params = node_params();
  Node node{params};
  EXPECT_FALSE(std::isfinite(sigma_rad(stand(node, 0, 20'000).back(), 0)));
  const RateMessage end = drive(node, 20'000, 30'000, 0.1F).back();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double turned =
        1.0 * static_cast<double>(axis + 1);  // the rig turns axis y twice as fast
    EXPECT_NEAR(turn_rad(end, axis), turned, 0.01);
    EXPECT_NEAR(sigma_rad(end, axis), 0.01 * turned, 0.002);
  }
  EXPECT_GE(end.turn_time, core::Duration::milliseconds(9'990));
  EXPECT_LE(end.turn_time, core::Duration::milliseconds(13'200));
}

TEST(TurnOfADrive, StaysUntilTheNextDeparture) {
  const auto params = node_params();
  Node node{params};
  stand(node, 0, 20'000);
  const RateMessage end = drive(node, 20'000, 30'000, 0.1F).back();
  const RateMessage at_rest = stand(node, 30'000, 50'000).back();
  EXPECT_NEAR(turn_rad(at_rest, 0), turn_rad(end, 0), 1e-3);
  const RateMessage next = drive(node, 50'000, 60'000, -0.1F).back();
  EXPECT_NEAR(turn_rad(next, 0), -1.0, 0.01);
}

/// Verifies SR-HEAD-02.
TEST(TurnOnTheSpot, IsSummedFromBeforeItWasNoticed) {
  const auto params = node_params();
  Node node{params};
  stand(node, 0, 20'000);
  stand(node, 20'000, 25'000, kBias + 0.2F);  // no pulse
  const RateMessage after = stand(node, 25'000, 26'000).back();
  EXPECT_NEAR(turn_rad(after, 0), 1.0, 0.01);
}

/// Verifies SR-HEAD-04.
TEST(TurnWithAGap, HasItsErrorUntilTheNextDeparture) {
  const auto params = node_params();
  Node node{params};
  stand(node, 0, 20'000);
  const double before = sigma_rad(drive(node, 20'000, 25'000, 0.0F).back(), 0);
  const double after = sigma_rad(drive(node, 25'500, 30'000, 0.0F).back(), 0);
  // 20 deg/s/sqrt(s) over half a second.
  const double gap = 20.0 * std::sqrt(0.5 * 0.5 * 0.51 / 12.0) / 57.3;
  EXPECT_NEAR(std::sqrt(after * after - before * before), gap, 0.1 * gap);
}

/// Verifies SR-HEAD-04.
TEST(TurnWhileTheGyroIsSilent, LosesItsInterval) {
  const auto params = node_params();
  Node node{params};
  stand(node, 0, 20'000);
  drive(node, 20'000, 25'000, 0.1F);
  const RateMessage silent = node.step_without_sample(at_ms(27'000));
  EXPECT_NEAR(turn_rad(silent, 0), 0.5, 0.01);
  EXPECT_GT(sigma_rad(silent, 0), 0.2);
}

/// Verifies SR-HEAD-05.
TEST(TurnOfAMachineThatSlept, IsNotKnown) {
  const auto params = node_params();
  Node node{params};
  stand(node, 0, 20'000);
  drive(node, 20'000, 25'000, 0.1F);
  node.report_pause(at_ms(25'000), core::Duration::seconds(60), false);
  EXPECT_FALSE(std::isfinite(sigma_rad(drive(node, 25'000, 26'000, 0.1F).back(), 0)));
}

/// Verifies SR-HEAD-05.
TEST(TurnWithFullScale, IsNotKnownOnThatAxis) {
  const auto params = node_params();
  Node node{params};
  stand(node, 0, 20'000);
  drive(node, 20'000, 22'000, 0.1F);
  core::GyroSample clipped = noisy_sample(at_ms(22'000), 4.0F);
  clipped.saturated_axes = 1U << 1U;
  node.pulse(clipped.time);
  node.step(clipped);
  const RateMessage end = drive(node, 22'010, 23'000, 0.1F).back();
  EXPECT_TRUE(std::isfinite(sigma_rad(end, 0)));
  EXPECT_FALSE(std::isfinite(sigma_rad(end, 1)));
}

TEST(TurnOfATiltedAxis, HoldsTheSlopesAtBothEnds) {
  const auto turn_variance = [](float slope_variance_rad2) {
    auto params = node_params();
    params.model.motion.slope_variance_rad2 = slope_variance_rad2;
    Node node{params};
    stand(node, 0, 20'000);
    const double sigma = sigma_rad(drive(node, 20'000, 25'000, 0.0F).back(), 0);
    return sigma * sigma;
  };
  EXPECT_NEAR(turn_variance(1e-4F) - turn_variance(0.0F), 2e-4, 1e-8);
}

TEST(TurnOfAWarmSensor, IsLessSureOfItsScaleFactor) {
  auto params = node_params();
  params.model.motion = {.scale_factor = 0.0F, .scale_factor_per_k = 1e-3F};
  const auto sigma_at = [&](float degc) {
    Node node{params};
    stand(node, 0, 20'000);
    RateMessage end;
    for (std::int64_t ms = 20'000; ms < 30'000; ms += 10) {
      core::GyroSample sample = noisy_sample(at_ms(ms), kBias + 0.1F);
      sample.temperature = core::Temperature::from_degc(degc);
      sample.has_temperature = true;
      node.pulse(sample.time);
      end = node.step(sample);
    }
    return sigma_rad(end, 0);
  };
  // 40 K make 4 % of a turn by a radian.
  EXPECT_NEAR(std::sqrt(std::pow(sigma_at(65.0F), 2.0) - std::pow(sigma_at(25.0F), 2.0)), 0.04,
              1e-3);
}

/// Oracle of the bias part: predict_heading() of the same node over the same time.
/// Verifies SR-HEAD-03.
TEST(ErrorOfTheTurn, IsThatOfTheFilterWhereNothingIsTurned) {
  auto params = node_params();
  params.model.motion = {.scale_factor = 0.0F};
  for (auto& mode : params.model.modes.decaying) mode.noise_variance *= 1e6F;
  Node node{params};
  stand(node, 0, 20'000);
  for (const std::int64_t end_ms : {24'000, 40'000, 100'000}) {
    const RateMessage end =
        drive(node, node.newest_sample().ns() / 1'000'000 + 10, end_ms, 0.0F).back();
    const auto predicted = node.predict_heading(Predictor::kalman, 0, at_ms(20'000), at_ms(end_ms));
    const double white =
        double{testing::kWhiteSigmaRadS} * std::sqrt(0.01 * double{end.turn_time.in_seconds()});
    const double expected = std::hypot(double{predicted.sigma_rad()}, white);
    EXPECT_GE(sigma_rad(end, 0), 0.97 * expected) << end_ms;
    EXPECT_LE(sigma_rad(end, 0), 1.25 * expected) << end_ms;
  }
}

}  // namespace
}  // namespace zerorate::app
