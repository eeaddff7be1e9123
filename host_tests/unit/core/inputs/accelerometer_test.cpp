#include "core/inputs/accelerometer.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <random>

namespace zerorate::core {
namespace {

constexpr Instant after_ms(std::int64_t ms) {
  return Instant::from_ns(ms * 1'000'000);
}

TEST(Accelerometer, HasMeanAndVarianceOfATick) {
  std::mt19937_64 random{3};
  std::normal_distribution<double> noise;
  Accelerometer accelerometer;
  accelerometer.begin_tick(after_ms(0));
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kReadings = 200;
  for (int k = 0; k < kReadings; ++k) {
    const double x = -0.5 + 0.02 * noise(random);
    accelerometer.take(after_ms(k), {static_cast<float>(x), 0.0F, 1.0F});
    sum += x;
    squares += x * x;
  }
  const double mean = sum / kReadings;
  const double variance = (squares - kReadings * mean * mean) / (kReadings - 1);
  accelerometer.begin_tick(after_ms(kReadings));
  EXPECT_NEAR(double{accelerometer.last_tick().mean_g[0]}, mean, 1e-6);
  EXPECT_NEAR(double{accelerometer.last_tick().vibration_g2} / variance, 1.0, 1e-4);
  EXPECT_TRUE(accelerometer.has_vibration());
}

TEST(AccelerometerWithFewReadings, ShowsNoVibration) {
  Accelerometer accelerometer;
  accelerometer.begin_tick(after_ms(0));
  for (std::int64_t ms = 0; ms < 3; ++ms) accelerometer.take(after_ms(ms), {0.1F, 0.0F, 1.0F});
  accelerometer.begin_tick(after_ms(500));
  EXPECT_FALSE(accelerometer.has_vibration());
  EXPECT_TRUE(accelerometer.is_known(after_ms(500)));
}

TEST(AccelerometerGivenNonsense, TakesItForNoReading) {
  Accelerometer accelerometer;
  accelerometer.begin_tick(after_ms(0));
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const float nonsense : {kNan, kInf, -kInf, 2e3F}) {
    accelerometer.take(after_ms(1), {0.0F, nonsense, 1.0F});
  }
  EXPECT_FALSE(accelerometer.is_known(after_ms(1)));
  EXPECT_EQ(accelerometer.this_tick().mean_g, SpecificForce{});
}

}  // namespace
}  // namespace zerorate::core
