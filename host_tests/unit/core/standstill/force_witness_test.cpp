#include "core/standstill/force_witness.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::core {
namespace {

constexpr bool kAlone = true;
constexpr std::uint32_t kReadings = 50;  // in a window of half a second

/// Windows of one tick each; returns how many of them were motion.
/// @param mean_g expected mean force along x of a window
int motions(ForceWitness& witness, int windows, double noise_g, bool is_alone,
            const std::function<double(int)>& mean_g, std::int64_t seed = 1) {
  const random::RandomStream random{static_cast<std::uint64_t>(seed), 3};
  int count = 0;
  for (int k = 0; k < windows; ++k) {
    SpecificForce mean{0.0F, 0.0F, 1.0F};
    for (std::size_t i = 0; i < 3; ++i) {
      mean.at(i) +=
          static_cast<float>(noise_g / std::sqrt(kReadings) *
                             random.normal(3 * std::int64_t{k} + static_cast<std::int64_t>(i)));
    }
    mean[0] += static_cast<float>(mean_g(k));
    witness.add({mean, static_cast<float>(3.0 * noise_g * noise_g), kReadings});
    count += witness.close(is_alone) == RestVerdict::motion ? 1 : 0;
  }
  return count;
}

// The sum of three ratios beyond 100, each with two degrees of freedom about a level that is no
// smaller than 0.3 of its mean: less than 1e-10 a window.
TEST(ForceWitnessOfWhiteNoise, FindsNoMotion) {
  for (const bool is_alone : {false, true}) {
    ForceWitness witness;
    EXPECT_EQ(motions(witness, 10'000, 0.002, is_alone, [](int) { return 0.0; }), 0);
  }
}

TEST(ForceWitnessOfAStart, FindsMotionInThreeWindows) {
  for (const bool is_alone : {false, true}) {
    ForceWitness witness;
    (void)motions(witness, 100, 0.002, is_alone, [](int) { return 0.0; });
    EXPECT_EQ(motions(witness, 20, 0.002, is_alone, [](int k) { return k < 10 ? 0.0 : 0.05; }), 2);
  }
}

TEST(ForceWitnessOfATiltByOneMilliG, FindsNoMotion) {
  ForceWitness witness;
  (void)motions(witness, 100, 1e-5, kAlone, [](int) { return 0.0; });
  EXPECT_EQ(motions(witness, 20, 1e-5, kAlone, [](int k) { return k < 10 ? 0.0 : 0.001; }), 0);
}

// A vibration of 50 mg rms, of whose mean over half a second 4 mg are left.
TEST(ForceWitnessOfAnEngine, CountsItAsRestBesideAnOdometer) {
  for (const bool is_alone : {false, true}) {
    ForceWitness witness;
    (void)motions(witness, 100, 0.0002, is_alone, [](int) { return 0.0; });
    int count = 0;
    for (int k = 0; k < 20; ++k) {
      const auto left_g = static_cast<float>(0.004 * std::cos(1.9 * k));
      witness.add({{left_g, left_g, 1.0F}, 0.05F * 0.05F, kReadings});
      count += witness.close(is_alone) == RestVerdict::motion ? 1 : 0;
    }
    EXPECT_EQ(count > 0, is_alone);
  }
}

TEST(ForceWitnessAfterAnEngine, NoLongerAllowsForIt) {
  ForceWitness witness;
  const auto window = [&](float mean_g, float vibration_g) {
    witness.add({{mean_g, mean_g, 1.0F}, vibration_g * vibration_g, kReadings});
    return witness.close(!kAlone);
  };
  for (int k = 0; k < 40; ++k) (void)window(0.0F, 0.5F);
  for (int k = 0; k < 10; ++k) (void)window(0.0F, 0.0F);
  EXPECT_EQ(window(0.01F, 0.0F), RestVerdict::motion);
}

TEST(ForceWitnessWithoutReadings, SaysNothing) {
  ForceWitness witness;
  (void)motions(witness, 100, 0.002, kAlone, [](int) { return 0.0; });
  witness.add({});
  EXPECT_EQ(witness.close(kAlone), RestVerdict::unknown);
  // The windows before the gap are not compared with those after it.
  EXPECT_EQ(motions(witness, 10, 0.002, kAlone, [](int) { return 0.05; }), 0);
}

}  // namespace
}  // namespace zerorate::core
