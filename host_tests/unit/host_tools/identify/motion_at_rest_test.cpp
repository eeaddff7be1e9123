// Stops in which a vehicle rolls and turns, and the same stops without.

#include "host_tools/lib/identify/rest_check.hpp"

#include <gtest/gtest.h>

#include <random>

namespace zerorate::identify {
namespace {

constexpr double kSigma_rad_s = 1e-3;
constexpr int kStops = 20;
constexpr int kSamplesOfStop = 150;  // at 10 Hz
constexpr int kSamplesOfCreep = 15;  // at the end of each stop

RestSamples stops(double creep_rad_s) {
  std::mt19937_64 random{17};
  std::normal_distribution<float> noise{0.0F, static_cast<float>(kSigma_rad_s)};
  RestSamples samples;
  samples.sample_period = core::Duration::milliseconds(100);
  std::int64_t ms = 0;
  for (int stop = 0; stop < kStops; ++stop) {
    if (stop > 0) samples.after_drives.push_back(samples.time.size());
    ms += 60'000;
    for (int k = 0; k < kSamplesOfStop; ++k, ms += 100) {
      const double turning = k >= kSamplesOfStop - kSamplesOfCreep ? creep_rad_s : 0.0;
      samples.time.push_back(core::Instant::from_ns(ms * 1'000'000));
      samples.rate_rad_s.push_back(
          {noise(random), noise(random), static_cast<float>(turning) + noise(random)});
    }
  }
  return samples;
}

TEST(MotionAtRest, IsNotFoundInNoise) {
  const MotionAtRest motion = find_motion(stops(0.0));
  EXPECT_EQ(motion.stops, std::size_t{kStops});
  EXPECT_EQ(motion.stops_with_motion, 0U);
  EXPECT_EQ(motion.share(), 0.0);
  EXPECT_FALSE(motion.is_usual());
}

TEST(MotionAtRest, IsFoundWhereTheVehicleCreepsAndLeftOut) {
  RestSamples samples = stops(20.0 * kSigma_rad_s);
  const MotionAtRest motion = find_motion(samples);
  EXPECT_EQ(motion.stops_with_motion, std::size_t{kStops});
  EXPECT_TRUE(motion.is_usual());
  // The creep, and at most the three windows of half a second that the judgement reaches.
  EXPECT_GE(motion.share(), 0.9 * kSamplesOfCreep / kSamplesOfStop);
  EXPECT_LE(motion.share(), (kSamplesOfCreep + 15.0) / kSamplesOfStop);
  EXPECT_NEAR(motion.turning_rad_s.back(), 20.0 * kSigma_rad_s, 3.0 * kSigma_rad_s);

  leave_out_motion(samples, motion);
  EXPECT_EQ(samples.after_drives.size(), std::size_t{kStops} - 1);
  for (const auto& rate : samples.rate_rad_s) EXPECT_LT(double{rate[2]}, 10.0 * kSigma_rad_s);
  EXPECT_EQ(samples.time.size() + samples.moving, std::size_t{kStops * kSamplesOfStop});
}

}  // namespace
}  // namespace zerorate::identify
