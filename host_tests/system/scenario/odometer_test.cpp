// Odometers that fail, and rotations that an odometer cannot measure.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "firmware/app/gyro_node.hpp"
#include "firmware/model/catalogue.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tests/system/scenario/play.hpp"
#include "host_tools/lib/random/random_stream.hpp"

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

/// Verifies SR-LEARN-05, SR-HEALTH-15.
TEST(SlowTurnWithADeadOdometer, IsReportedIn2sAndNotLearnt) {
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
  // The watch for chatter judges windows of five seconds.
  EXPECT_FALSE(played.disagrees(171.0));
  EXPECT_EQ(played.samples(core::Motion::still, 140.0, 160.0), 0U);
  EXPECT_LT(played.worst_dps(60.0, 360.0), kWanderDps);
}

constexpr core::ModelShape kTurntableShape =
    core::with_hypotheses(core::ModelShape{.decaying = 6}, 12);
using TurntableNode = app::GyroNode<kTurntableShape, app::NodeCapacity{.held_ticks = 256}>;

struct Turntable {
  double filter_hz = 2.0;
  double turn_dps = 1.0;
  double nominal_hz = 100.0;
  double real_hz = 100.0;
};

/// Time for which the messages were healthy and the bias off by more than five deviations.
struct Harm {
  double unseen_s = 0.0;
  double worst_dps = 0.0;
};

/// A vehicle with an ADIS16405 that is parked for ten minutes; a turntable turns it about z from
/// the fifth to the seventh half minute, and no pulse comes.
Harm on_a_turntable(const Turntable& setting) {
  const auto period = core::Duration::nanoseconds(std::llround(1e9 / setting.nominal_hz));
  const auto tick = core::Duration::nanoseconds(std::llround(1e9 / setting.filter_hz));
  const auto noise = model::make_node_model<kTurntableShape>(model::find_model("adis16405"), period,
                                                             std::max(tick, period));
  const TurntableNode::Params params{
      .model = {.modes = noise.modes,
                .white_variance_rad2_s2 = noise.white_variance_rad2_s2,
                .measurement_floor_variance_rad2_s2 = noise.measurement_floor_variance_rad2_s2,
                .sample_period = period,
                .hypotheses = noise.hypotheses}};
  TurntableNode node{params};
  constexpr double kRadPerDegree = std::numbers::pi / 180.0;
  constexpr std::array<double, 3> kBias_dps{1.0, -0.4, 0.2};
  constexpr double kFlicker_dps = 0.003;  // step of the level's random walk in one second
  const double white = std::sqrt(double{params.model.white_variance_rad2_s2});
  const double period_s = 1.0 / setting.real_hz;
  double walk_dps = 0.0;
  Harm harm;
  for (std::int64_t k = 0; static_cast<double>(k) * period_s < 600.0; ++k) {
    const double t_s = static_cast<double>(k) * period_s;
    walk_dps += kFlicker_dps * 0.1 * std::sqrt(period_s) * random::RandomStream{3, 9}.normal(k);
    const bool turns = t_s >= 150.0 && t_s < 180.0;
    core::GyroSample sample{.time = core::Instant::from_ns(std::llround(1e9 * t_s))};
    for (std::size_t i = 0; i < 3; ++i) {
      const double turn_dps = turns && i == 2 ? setting.turn_dps : 0.0;
      const double rate = kRadPerDegree * (kBias_dps[i] + walk_dps + turn_dps) +
                          white * random::RandomStream{3, i}.normal(k);
      sample.rate[i] = core::rad_per_s(static_cast<float>(rate));
    }
    app::Health health = node.step(sample).health;
    const bool is_calibrated = health.calibrated;
    health.calibrated = false;
    if (!is_calibrated || health != app::Health{}) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const core::Prediction predicted = node.predict(app::Predictor::kalman, i);
      const double off = double{predicted.bias_rad_s} - kRadPerDegree * (kBias_dps[i] + walk_dps);
      if (std::abs(off) <= 5.0 * double{predicted.sigma_rad_s()}) continue;
      harm.unseen_s += period_s;
      harm.worst_dps = std::max(harm.worst_dps, std::abs(off) / kRadPerDegree);
      break;
    }
  }
  return harm;
}

TEST(Turntable, IsNeverBelievedUnseenAtAnyFilterRate) {
  for (const double filter_hz : {2.0, 10.0, 50.0, 100.0}) {
    for (const double turn_dps : {0.3, 0.6, 1.0, 2.0, 2.9}) {
      const Harm harm = on_a_turntable({.filter_hz = filter_hz, .turn_dps = turn_dps});
      EXPECT_EQ(harm.unseen_s, 0.0)
          << filter_hz << " Hz, " << turn_dps << " deg/s, off by " << harm.worst_dps << " deg/s";
    }
  }
}

// The sensor is slower than its nominal rate, as after an export without --sample-rate.
TEST(Turntable, IsNeverBelievedUnseenAtAnyRealSampleRate) {
  for (const double real_hz : {140.0, 75.0, 71.0, 50.0, 30.0}) {
    const Harm harm = on_a_turntable({.turn_dps = 3.0, .real_hz = real_hz});
    EXPECT_EQ(harm.unseen_s, 0.0) << real_hz << " Hz, off by " << harm.worst_dps << " deg/s";
  }
}

}  // namespace
}  // namespace zerorate::scenario
