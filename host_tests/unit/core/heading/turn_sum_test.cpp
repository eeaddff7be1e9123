// The turn since departure against sums in double, and the parts of its error.

#include "core/heading/turn_sum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::core {
namespace {

using Sum = TurnSum<1>;

constexpr Duration kPeriod = Duration::milliseconds(10);
constexpr Duration kWindow = Duration::milliseconds(1500);
constexpr float kDeg = std::numbers::pi_v<float> / 180.0F;
constexpr MotionModel kPerfect{.scale_factor = 0.0F};

/// A sensor at 100 Hz with ticks of a second.
struct Vehicle {
  explicit Vehicle(const MotionModel& model, Duration sample_period = kPeriod)
      : sum(model, sample_period, kWindow), period(sample_period) {}

  void run(double seconds, float rate_rad_s, bool moves, std::uint8_t saturated = 0) {
    const auto samples = std::llround(seconds / 1e-9 / static_cast<double>(period.ns()));
    for (std::int64_t k = 0; k < samples; ++k) take(period, rate_rad_s, moves, saturated);
  }
  void take(Duration since_last, float rate_rad_s, bool moves, std::uint8_t saturated = 0) {
    in_tick = in_tick + since_last;
    if (in_tick >= Duration::seconds(1)) {
      in_tick = in_tick - Duration::seconds(1);
      sum.close_tick();
    }
    if (moves && !sum.moves() && sum.has_rested(measured_ticks))
      sum.depart({white_variance}, temperature_k);
    if (moves) sum.note_measurement(measured_ticks);
    sum.add({.since_last = since_last,
             .rate_rad_s = {rate_rad_s},
             .bias_sigma_rad_s = {bias_sigma},
             .saturated_axes = saturated,
             .moves = moves});
  }
  [[nodiscard]] double angle_deg() const { return double{sum.angle(0).in(deg)}; }
  [[nodiscard]] double sigma_deg() const {
    return double{sum.sigma(0, sum.scale_variance_rad2(0)).in(deg)};
  }

  Sum sum;
  Duration period;
  Duration in_tick;
  float temperature_k = 0.0F;
  float white_variance = 0.0F;
  float bias_sigma = 0.0F;
  std::uint32_t measured_ticks = 1;
};

TEST(TurnSum, IsLessSureOfTheScaleFactorWhereItIsWarm) {
  const auto sigma_deg = [](float temperature_k) {
    const MotionModel model{.scale_factor = 0.01F, .scale_factor_per_k = 3e-4F};
    Vehicle vehicle{model};
    vehicle.temperature_k = temperature_k;
    vehicle.run(10.0, 0.0F, false);
    vehicle.run(10.0, 10.0F * kDeg, true);
    return vehicle.sigma_deg();
  };
  EXPECT_NEAR(sigma_deg(298.15F), 1.0, 0.01);
  EXPECT_NEAR(sigma_deg(338.15F), std::hypot(1.0, 1.2), 0.01) << "40 K warmer";
  EXPECT_NEAR(sigma_deg(258.15F), std::hypot(1.0, 1.2), 0.01) << "40 K colder";
  EXPECT_NEAR(sigma_deg(0.0F), 1.0, 0.01) << "no thermometer";
}

/// Verifies SR-HEAD-01.
TEST(TurnSum, IsTheIntegralSinceDeparture) {
  Vehicle vehicle{kPerfect};
  vehicle.run(20.0, 0.0F, false);
  vehicle.run(9.0, 10.0F * kDeg, true);
  vehicle.run(9.0, -4.0F * kDeg, true);
  // Half a sample at each change of the rate.
  EXPECT_NEAR(vehicle.angle_deg(), 54.0, 0.11);
  EXPECT_GE(vehicle.sum.duration(), Duration::seconds(18));
  EXPECT_LE(vehicle.sum.duration(), Duration::seconds(18) + kWindow * 2 + Duration::seconds(2));
}

/// Verifies SR-HEAD-01.
TEST(TurnSum, LosesNothingInAnHourAtAKilohertz) {
  Vehicle vehicle{kPerfect, Duration::milliseconds(1)};
  const random::RandomStream noise{5, 0};
  vehicle.take(vehicle.period, 0.0F, false);
  double turn_rad = 0.0;
  float before = 0.0F;
  for (std::int64_t k = 0; k < 3'600'000; ++k) {
    const float rate = 1.0F + 0.01F * static_cast<float>(noise.normal(k));
    vehicle.take(vehicle.period, rate, true);
    turn_rad += 0.5e-3 * (double{before} + double{rate});
    before = rate;
  }
  // The nearest float to the angle, and to a millisecond, are off by 6e-8.
  EXPECT_NEAR(double{vehicle.sum.angle(0).in(rad)} / turn_rad, 1.0, 2e-7);
}

/// Verifies SR-HEAD-02.
TEST(TurnSum, BeginsBeforeTheMotionWasNoticed) {
  Vehicle vehicle{kPerfect};
  vehicle.run(20.0, 0.0F, false);
  vehicle.run(1.4, 30.0F * kDeg, false);  // a turn on the spot, before the verdict of the gyro
  vehicle.run(1.6, 30.0F * kDeg, true);
  EXPECT_NEAR(vehicle.angle_deg(), 90.0, 0.2);
}

TEST(TurnSum, KeepsTheTurnOfADriveUntilTheNext) {
  Vehicle vehicle{kPerfect};
  vehicle.run(20.0, 0.0F, false);
  vehicle.run(9.0, 10.0F * kDeg, true);
  vehicle.run(30.0, 0.5F * kDeg, false);  // a bias at rest is no turn
  EXPECT_NEAR(vehicle.angle_deg(), 90.0, 0.11);
  vehicle.measured_ticks = 40;
  vehicle.run(1.0, 0.0F, false);
  vehicle.run(3.0, 10.0F * kDeg, true);
  EXPECT_NEAR(vehicle.angle_deg(), 30.0, 2.0);
}

TEST(TurnSum, GoesOnOverAStopThatNothingWasLearntFrom) {
  Vehicle vehicle{kPerfect};
  vehicle.run(20.0, 0.0F, false);
  vehicle.run(9.0, 10.0F * kDeg, true);
  vehicle.run(2.0, 0.0F, false);
  vehicle.run(3.0, 10.0F * kDeg, true);
  EXPECT_NEAR(vehicle.angle_deg(), 120.0, 0.3);
}

TEST(TurnSum, CountsATurnBeforeTheMotionWasNoticedOnce) {
  Vehicle vehicle{kPerfect};
  vehicle.run(20.0, 0.0F, false);
  vehicle.run(1.4, 30.0F * kDeg, false);
  vehicle.run(1.6, 30.0F * kDeg, true);
  vehicle.measured_ticks = 40;
  vehicle.run(0.5, 0.0F, false);
  vehicle.run(3.0, 0.0F, true);
  EXPECT_NEAR(vehicle.angle_deg(), 0.0, 0.2);
}

/// Verifies SR-HEAD-03.
TEST(TurnSum, HasTheErrorOfTheScaleFactorAndOfTheAsymmetry) {
  constexpr MotionModel kModel{.scale_factor = 0.01F, .asymmetry = 0.002F};
  Vehicle vehicle{kModel};
  vehicle.run(20.0, 0.0F, false);
  vehicle.run(9.0, 20.0F * kDeg, true);
  vehicle.run(9.0, -10.0F * kDeg, true);
  EXPECT_NEAR(vehicle.sigma_deg(), std::hypot(0.01 * 90.0, 0.002 * 270.0), 0.01);
}

/// Verifies SR-HEAD-03.
TEST(TurnSum, HasTheErrorOfTheWhiteNoise) {
  Vehicle vehicle{kPerfect};
  vehicle.white_variance = 0.01F * kDeg * kDeg;  // 0.1 deg/s a sample: 0.01 deg/s/sqrt(Hz)
  vehicle.run(1.0, 0.0F, false);
  vehicle.run(400.0, 0.0F, true);
  const double length_s = double{vehicle.sum.duration().in_seconds()};
  EXPECT_NEAR(vehicle.sigma_deg(), 0.01 * std::sqrt(length_s), 0.002);
}

/// Verifies SR-HEAD-03.
TEST(TurnSum, GrowsByTheErrorOfTheBias) {
  Vehicle vehicle{kPerfect};
  vehicle.bias_sigma = 0.01F * kDeg;
  vehicle.run(1.0, 0.0F, false);
  vehicle.run(100.0, 0.0F, true);
  EXPECT_NEAR(vehicle.sigma_deg(), 0.01 * double{vehicle.sum.duration().in_seconds()}, 1e-3);
  vehicle.sum.set_bias_variance(0, 0.25F * kDeg * kDeg);
  EXPECT_NEAR(vehicle.sigma_deg(), 0.5, 1e-3);
  vehicle.run(10.0, 0.0F, true);
  EXPECT_NEAR(vehicle.sigma_deg(), 0.6, 1e-3);
}

/// Verifies SR-HEAD-04.
TEST(TurnSum, HasTheErrorOfAGapInATurn) {
  Vehicle vehicle{kPerfect};
  vehicle.run(20.0, 0.0F, false);
  vehicle.run(2.0, 10.0F * kDeg, true);
  EXPECT_LT(vehicle.sigma_deg(), 1e-6);
  vehicle.take(Duration::seconds(1), 10.0F * kDeg, true);
  EXPECT_NEAR(vehicle.angle_deg(), 30.0, 0.2);
  EXPECT_NEAR(vehicle.sigma_deg(), 20.0 / std::sqrt(12.0), 0.01);
  EXPECT_GT(vehicle.sum.sigma(0, 0.0F, Duration::seconds(3)).in(deg), 25.0F);
}

TEST(TurnSum, HasTheTurnAndTheErrorOfAGapThatEndsAtRest) {
  Vehicle vehicle{kPerfect};
  vehicle.run(20.0, 0.0F, false);
  vehicle.run(2.0, 10.0F * kDeg, true);
  vehicle.take(Duration::seconds(1), 10.0F * kDeg, false);
  EXPECT_FALSE(vehicle.sum.moves());
  EXPECT_NEAR(vehicle.angle_deg(), 30.0, 0.2);
  EXPECT_NEAR(vehicle.sigma_deg(), 20.0 / std::sqrt(12.0), 0.01);
  vehicle.run(20.0, 0.0F, false);
  EXPECT_NEAR(vehicle.angle_deg(), 30.0, 0.2);
  EXPECT_NEAR(vehicle.sigma_deg(), 20.0 / std::sqrt(12.0), 0.01);
}

TEST(TurnSum, HasTheErrorOfAGapBeforeMotionIsNoticed) {
  Vehicle vehicle{kPerfect};
  vehicle.run(20.0, 0.0F, false);
  vehicle.take(Duration::seconds(1), 10.0F * kDeg, false);
  vehicle.run(2.0, 10.0F * kDeg, true);
  EXPECT_NEAR(vehicle.angle_deg(), 25.0, 0.2);  // the rate rose within the gap
  EXPECT_NEAR(vehicle.sigma_deg(), 20.0 / std::sqrt(12.0), 0.01);
}

/// Verifies SR-HEAD-05.
TEST(TurnSum, IsUnknownAfterFullScaleUntilTheNextDeparture) {
  Vehicle vehicle{kPerfect};
  vehicle.run(20.0, 0.0F, false);
  vehicle.run(1.0, 10.0F * kDeg, true);
  vehicle.run(0.1, 250.0F * kDeg, true, 1);
  vehicle.run(5.0, 10.0F * kDeg, true);
  EXPECT_FALSE(std::isfinite(vehicle.sigma_deg()));
  vehicle.measured_ticks = 40;
  vehicle.run(5.0, 0.0F, false);
  vehicle.run(1.0, 10.0F * kDeg, true);
  EXPECT_TRUE(std::isfinite(vehicle.sigma_deg()));
}

/// Verifies SR-HEAD-05.
TEST(TurnSum, IsUnknownBeforeTheFirstDeparture) {
  Vehicle vehicle{kPerfect};
  vehicle.measured_ticks = 0;
  vehicle.run(5.0, 0.0F, false);
  vehicle.run(5.0, 10.0F * kDeg, true);
  EXPECT_FALSE(std::isfinite(vehicle.sigma_deg()));
}

TEST(TurnSum, IsUnknownAfterTimeThatNothingMeasured) {
  Vehicle vehicle{kPerfect};
  vehicle.run(20.0, 0.0F, false);
  vehicle.run(5.0, 10.0F * kDeg, true);
  vehicle.sum.lose();
  EXPECT_FALSE(std::isfinite(vehicle.sigma_deg()));
}

TEST(TurnSum, NeverTakesAnUnknownBiasForAKnownOne) {
  Vehicle vehicle{kPerfect};
  vehicle.bias_sigma = std::numeric_limits<float>::infinity();
  vehicle.take({}, 0.0F, true);
  vehicle.run(1.0, 0.0F, true);
  EXPECT_FALSE(std::isfinite(vehicle.sigma_deg()));
}

TEST(TurnSum, GoesOnFromItsState) {
  constexpr MotionModel kModel{.scale_factor = 0.01F};
  Vehicle vehicle{kModel};
  vehicle.run(20.0, 0.0F, false);
  vehicle.run(7.3, 20.0F * kDeg, true);
  Vehicle other{kModel};
  other.sum.restore(vehicle.sum.state());
  other.in_tick = vehicle.in_tick;
  vehicle.run(3.0, 5.0F * kDeg, true);
  other.run(3.0, 5.0F * kDeg, true);
  EXPECT_TRUE(vehicle.sum.state() == other.sum.state());
  EXPECT_TRUE(Sum::is_possible(other.sum.state()));
}

}  // namespace
}  // namespace zerorate::core
