// Odometers that fail, and rotations of which an odometer knows nothing.

#include <gtest/gtest.h>

#include "host_tests/system/scenario/play.hpp"

namespace zerorate::scenario {
namespace {

/// When the first disagreement at or after this time was published.
double first_disagreement_s(const Played& played, double from_s) {
  double first_s = 1e9;
  played.between(from_s, 1e9, [&](std::size_t row) {
    if (played.messages[row].health.odometer_disagreement) {
      first_s = std::min(first_s, played.time_s(row));
    }
  });
  return first_s;
}

TEST(SlowTurnWithADeadOdometer, IsReportedWithinTwoSecondsAndNotLearnt) {
  const Played played = play("slow-turn-dead-odometer");
  const double reported_s = first_disagreement_s(played, 0.0);
  RecordProperty("reported_after_ms", static_cast<int>(1000.0 * (reported_s - 60.0)));
  EXPECT_GT(reported_s, 60.0);
  EXPECT_LT(reported_s, 62.0);
  EXPECT_TRUE(played.disagrees(119.0));
  const double worst_dps = played.worst_dps(60.0, 150.0);
  RecordProperty("worst_udps", static_cast<int>(1e6 * worst_dps));
  EXPECT_LT(worst_dps, 0.05);
  EXPECT_FALSE(played.disagrees(149.0));
}

TEST(Carousel, IsReportedAndNotLearnt) {
  const Played played = play("carousel");
  EXPECT_LT(first_disagreement_s(played, 60.0), 62.0);
  EXPECT_TRUE(played.disagrees(149.0));
  EXPECT_LT(played.worst_dps(60.0, 210.0), 0.05);
  EXPECT_FALSE(played.disagrees(209.0));
}

TEST(Ferry, IsReportedAndNotLearnt) {
  const Played played = play("ferry");
  EXPECT_LT(first_disagreement_s(played, 120.0), 124.0);
  EXPECT_LT(played.worst_dps(60.0, 850.0), 0.05);
  EXPECT_FALSE(played.disagrees(840.0));
  EXPECT_GT(played.samples(core::Motion::still, 820.0, 850.0), 25U * 104U);
}

TEST(DeadEncoder, IsReportedInTurnsWhichAreNotLearnt) {
  const Played played = play("dead-encoder");
  EXPECT_LT(first_disagreement_s(played, 600.0), 1'000.0);
  // The first third of a degree per second of each turn is learnt.
  RecordProperty("worst_udps", static_cast<int>(1e6 * played.worst_dps(600.0, 1'800.0)));
  EXPECT_LT(played.worst_dps(60.0, 1'800.0), 0.15);
}

TEST(BouncingEncoder, IsReportedAndTheNextStopIsLearnt) {
  const Played played = play("bouncing-encoder");
  EXPECT_FALSE(played.disagrees(139.0));
  EXPECT_TRUE(played.disagrees(141.0));
  EXPECT_TRUE(played.disagrees(159.0));
  EXPECT_FALSE(played.disagrees(164.0));
  EXPECT_EQ(played.samples(core::Motion::still, 140.0, 160.0), 0U);
  EXPECT_LT(played.worst_dps(60.0, 360.0), kWanderDps);
}

}  // namespace
}  // namespace zerorate::scenario
