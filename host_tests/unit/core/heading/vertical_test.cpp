#include "core/heading/vertical.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace zerorate::core {
namespace {

constexpr double kRadPerDegree = std::numbers::pi / 180.0;
constexpr Duration kTick = Duration::milliseconds(500);

Direction direction_of(const Eigen::Vector3d& one) {
  return {static_cast<float>(one.x()), static_cast<float>(one.y()), static_cast<float>(one.z())};
}
double degrees_between(const Direction& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d difference = Eigen::Vector3d(double{a[0]}, double{a[1]}, double{a[2]}) - b;
  return difference.norm() / kRadPerDegree;
}
void rest(MeasuredVertical& vertical, const Eigen::Vector3d& up, int ticks = 20) {
  const Direction force = direction_of(up);
  for (int k = 0; k < ticks; ++k) vertical.close_tick(&force, true, 0.0F, kTick);
}

TEST(MeasuredVerticalAtRest, IsTheMeanForceOfTheStop) {
  MeasuredVertical vertical{std::nullopt};
  EXPECT_FALSE(vertical.is_known());
  const Eigen::Vector3d up = Eigen::Vector3d(0.3, -0.5, 0.8).normalized();
  for (int k = 0; k < 40; ++k) {
    Direction force = direction_of(up);
    force[0] += k % 2 == 0 ? 0.01F : -0.01F;
    vertical.close_tick(&force, true, 0.0F, kTick);
  }
  EXPECT_TRUE(vertical.is_known());
  EXPECT_LT(degrees_between(vertical.up(), up), 0.02);
}

// A sensor that turns about all axes at once for a minute, against the product of exact rotations.
TEST(MeasuredVerticalInMotion, FollowsExactRotations) {
  MeasuredVertical vertical{std::nullopt};
  Eigen::Vector3d up = Eigen::Vector3d(0.1, 0.2, 1.0).normalized();
  rest(vertical, up);
  constexpr double kInterval_s = 0.01;
  for (int k = 0; k < 6000; ++k) {
    const double t_s = k * kInterval_s;
    const Eigen::Vector3d rate(0.3 * std::sin(t_s), 0.2 * std::cos(0.7 * t_s), 0.5);
    vertical.turn(direction_of(rate * kInterval_s));
    up = Eigen::AngleAxisd(-rate.norm() * kInterval_s, rate.normalized()) * up;
    if (k % 50 == 49) vertical.close_tick(nullptr, false, 0.5F, kTick);
  }
  EXPECT_LT(degrees_between(vertical.up(), up), 0.02);
}

TEST(MeasuredVerticalInMotion, ForgetsErrorsOfTheRatesOverMinutes) {
  MeasuredVertical vertical{std::nullopt};
  const Eigen::Vector3d up(0.0, 0.0, 1.0);
  rest(vertical, up);
  const Direction force = direction_of(up);
  const auto bias_rad_s = static_cast<float>(0.02 * kRadPerDegree);
  for (int k = 0; k < 600 * 20; ++k) {
    vertical.turn({0.05F * bias_rad_s, 0.0F, 0.0F});
    if (k % 10 == 9) vertical.close_tick(&force, false, 0.0F, kTick);
  }
  // The time constant of a minute leaves a minute's error of the rate.
  EXPECT_NEAR(degrees_between(vertical.up(), up), 0.02 * 60.0, 0.05);
}

TEST(MeasuredVerticalInACurve, IgnoresTheForce) {
  MeasuredVertical vertical{std::nullopt};
  const Eigen::Vector3d up(0.0, 0.0, 1.0);
  rest(vertical, up);
  const Direction leaning{0.0F, 0.15F, 1.0F};
  for (int k = 0; k < 240; ++k) vertical.close_tick(&leaning, false, 0.2F, kTick);
  EXPECT_LT(degrees_between(vertical.up(), up), 1e-3);
}

TEST(MeasuredVerticalOfAForceThatIsNoGravity, StaysUnknownOrGiven) {
  for (const Direction force :
       {Direction{0.0F, 0.0F, 0.0F}, Direction{0.0F, 0.0F, 0.5F}, Direction{0.0F, 0.0F, 2.0F}}) {
    MeasuredVertical vertical{std::nullopt};
    for (int k = 0; k < 20; ++k) vertical.close_tick(&force, true, 0.0F, kTick);
    EXPECT_FALSE(vertical.is_known());
  }
  MeasuredVertical given{UpAxis{.axis = 2, .points_down = true}};
  rest(given, {0.0, 0.0, 1.0});
  EXPECT_EQ(given.up(), (Direction{0.0F, 0.0F, -1.0F}));
}

TEST(MeasuredVerticalWithoutReadings, StaysTheGivenAxis) {
  MeasuredVertical given{UpAxis{.axis = 0}};
  for (int k = 0; k < 100; ++k) {
    given.turn({0.1F, 0.2F, 0.3F});
    given.close_tick(nullptr, k % 2 == 0, 0.3F, kTick);
  }
  EXPECT_EQ(given.up(), (Direction{1.0F, 0.0F, 0.0F}));
}

TEST(MeasuredVerticalOfSeveralStops, GivesTheSlopeOfAParkingPlace) {
  MeasuredVertical vertical{std::nullopt};
  const Eigen::Vector3d level(0.0, 0.0, 1.0);
  for (int stop = 0; stop < 10; ++stop) {
    rest(vertical, level);
    vertical.close_tick(nullptr, false, 0.0F, kTick);
  }
  const double slope_rad = std::atan(0.05);
  rest(vertical, {std::sin(slope_rad), 0.0, std::cos(slope_rad)});
  ASSERT_TRUE(vertical.slope());
  EXPECT_NEAR(double{vertical.slope()->in(rad)}, slope_rad, 1e-3);
}

TEST(MeasuredVertical, GivesTheVarianceAboutTheVertical) {
  MeasuredVertical vertical{std::nullopt};
  const Eigen::Vector3d up = Eigen::Vector3d(0.0, 3.0, 4.0).normalized();
  rest(vertical, up);
  std::array<float, 4> variances{100.0F, 1.0F, 4.0F};
  vertical.complete_variances(variances);
  EXPECT_NEAR(variances[3], 0.36F * 1.0F + 0.64F * 4.0F, 1e-4F);
}

TEST(EarthAboutAVertical, HasTheSameRotationInAll) {
  const EarthRate level = earth_rate(50.0F, UpAxis{});
  const Eigen::Vector3d up = Eigen::Vector3d(0.2, -0.3, 0.9).normalized();
  const EarthRate askew = level.about(UpAxis{}, direction_of(up));
  double square = 0.0;
  double level_variance = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    square += double{askew.vertical_rad_s.at(i)} * double{askew.vertical_rad_s.at(i)};
    level_variance += double{askew.heading_variance_rad2_s2.at(i)};
  }
  EXPECT_NEAR(std::sqrt(square), double{level.vertical_rad_s[2]}, 1e-9);
  // Two level axes in all directions, however the sensor is mounted.
  EXPECT_NEAR(level_variance, 2.0 * double{level.heading_variance_rad2_s2[0]}, 1e-14);
}

}  // namespace
}  // namespace zerorate::core
