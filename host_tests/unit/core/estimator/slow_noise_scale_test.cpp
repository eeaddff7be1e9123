#include "core/estimator/slow_noise_scale.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace zerorate::core {
namespace {

using Scale = SlowNoiseScale<3>;

/// Stops whose biases wander with `truth` times the variance that the model says, and whose
/// measurements have the noise by which each resolves `share` of it: the gain is `share`.
void play(Scale& scale, int stops, double truth, double share, std::mt19937& random,
          double* mean_square = nullptr) {
  constexpr double kBefore = 4e-10;
  std::normal_distribution<double> normal;
  for (int stop = 0; stop < stops; ++stop) {
    const auto before = static_cast<float>(kBefore);
    scale.begin_stop({}, before);
    std::array<float, 3> moved{};
    for (float& one : moved) {
      const double sigma = std::sqrt(share * (share * truth + 1.0 - share) * kBefore);
      const double d = sigma * normal(random);
      one = static_cast<float>(d);
      if (mean_square != nullptr) *mean_square += d * d / (share * kBefore) / (3.0 * stops);
    }
    scale.end_stop(moved, static_cast<float>((1.0 - share) * kBefore));
  }
}

// The batch estimate of a variance is the mean of the squares; the recursion gathers the same
// information. 40 stops of 3 axes know a variance within sqrt(2 / 120), 13 %; the recursion may
// differ from the batch by twice that. From a hundred times above the truth it comes down like a
// mean, as one over the stops, and stays on the cautious side.
TEST(SlowNoiseScaleAfterFortyStops, AgreesWithTheMeanOfTheSquares) {
  for (const double truth : {0.01, 0.1, 1.0, 10.0, 100.0}) {
    std::mt19937 random{7};
    Scale scale;
    double batch = 0.0;
    play(scale, 40, truth, 1.0, random, &batch);
    const double excess = std::log(double{scale.scale()} / batch);
    EXPECT_GE(excess, -0.26) << truth;
    EXPECT_LE(excess, truth < 0.1 ? 1.0 : 0.26) << truth;
  }
}

TEST(SlowNoiseScaleOfStopsThatTellNothing, Stays) {
  Scale scale;
  std::mt19937 random{7};
  play(scale, 40, 3.0, 1e-3, random);
  EXPECT_NEAR(double{scale.scale()}, 1.0, 0.2);
}

TEST(SlowNoiseScaleOfOneWildStop, RisesByABoundedFactor) {
  Scale scale;
  std::mt19937 random{7};
  play(scale, 40, 1.0, 1.0, random);
  const float before = scale.scale();
  scale.begin_stop({}, 4e-10F);
  scale.end_stop({1.0F, 1.0F, 1.0F}, 0.0F);
  // 3 x (16 - 1) / 2 over the information of 41 stops.
  EXPECT_NEAR(double{scale.scale() / before}, 1.0 + 22.5 / 60.0, 0.02);
}

TEST(SlowNoiseScaleBeforeItKnowsMuch, IsCautious) {
  Scale scale;
  EXPECT_FLOAT_EQ(scale.cautious_scale(), 3.0F);
  std::mt19937 random{7};
  play(scale, 40, 1.0, 1.0, random);
  EXPECT_LT(scale.cautious_scale(), 1.02F * scale.scale());
}

TEST(SlowNoiseScaleAnchored, StartsAtTheSquareRootOfTheWhiteLevelOnce) {
  Scale scale;
  scale.anchor(1.0F / 16.0F);
  scale.anchor(100.0F);
  EXPECT_FLOAT_EQ(scale.scale(), 0.25F);
}

TEST(SlowNoiseScaleInALongStop, JudgesItsFirstTwentyTicks) {
  Scale early;
  early.begin_stop({}, 4e-10F);
  for (int tick = 0; tick < 20; ++tick) early.on_tick({4e-5F, 0.0F, 0.0F}, 1e-10F);
  const float judged = early.scale();
  EXPECT_NE(judged, 1.0F);
  for (int tick = 0; tick < 500; ++tick) early.on_tick({1.0F, 1.0F, 1.0F}, 1e-12F);
  early.end_stop({1.0F, 1.0F, 1.0F}, 1e-12F);
  EXPECT_EQ(early.scale(), judged);
}

TEST(SlowNoiseScaleRestored, GoesOnBitForBit) {
  std::mt19937 random{7};
  Scale one;
  play(one, 5, 3.0, 0.7, random);
  Scale other;
  other.restore(one.state());
  std::mt19937 again = random;
  play(one, 5, 3.0, 0.7, random);
  play(other, 5, 3.0, 0.7, again);
  EXPECT_EQ(one.state(), other.state());
}

}  // namespace
}  // namespace zerorate::core
