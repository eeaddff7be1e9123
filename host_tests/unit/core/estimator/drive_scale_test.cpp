#include "core/estimator/drive_scale.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::core {
namespace {

constexpr float kBefore = 4e-10F;  ///< predicted variance when a stop begins

/// Two hypotheses that are of one mind.
struct Bank {
  static constexpr std::size_t kHypotheses = 2;
  static constexpr std::size_t kAxes = 3;
  struct Coefficients {
    static constexpr std::size_t kInputs = 0;
  };
  struct Transition {};
  struct Filter {
    float bias_variance = 0.0F;
  };
  struct Weight {
    float weight = 0.5F;
  };
  struct Evidence {
    std::array<std::array<Weight, kAxes>, kHypotheses> hypotheses{};
    [[nodiscard]] static float mean_scale(std::size_t /*m*/, std::size_t /*axis*/) { return 2.0F; }
  };
  struct State {
    std::array<float, kAxes> bias_rad_s{};
    std::array<Filter, kHypotheses> filters{};
    Evidence evidence;

    [[nodiscard]] std::array<Prediction, kAxes> newest() const {
      std::array<Prediction, kAxes> all{};
      for (std::size_t i = 0; i < kAxes; ++i) {
        all[i] = {bias_rad_s[i], 2.0F * filters[0].bias_variance};
      }
      return all;
    }
  };
};
using Scale = DriveScale<Bank>;

Bank::State biases(const std::array<float, 3>& bias_rad_s, float variance_rad2_s2) {
  const Bank::Filter filter{0.5F * variance_rad2_s2};
  return {.bias_rad_s = bias_rad_s, .filters = {filter, filter}, .evidence = {}};
}

/// Stops whose biases moved with `truth` times the variance that was predicted, each resolving
/// `share` of it: the gain is `share`.
/// @param first stop of the sequence of random numbers
/// @return the mean of the squares of the moves over what they should be with a scale of 1
double play(Scale& scale, int stops, double truth, double share, int first = 0) {
  const random::RandomStream noise{7};
  double sum = 0.0;
  for (int stop = 0; stop < stops; ++stop) {
    scale.begin_stop(biases({}, kBefore), {});
    std::array<float, 3> moved{};
    for (std::size_t i = 0; i < 3; ++i) {
      const double sigma = std::sqrt(share * (share * truth + 1.0 - share) * double{kBefore});
      const double d = sigma * noise.normal(3 * (first + stop) + static_cast<int>(i));
      moved[i] = static_cast<float>(d);
      sum += d * d / (share * double{kBefore});
    }
    scale.end_stop(biases(moved, static_cast<float>(1.0 - share) * kBefore));
  }
  return sum / (3.0 * stops);
}

// The batch estimate of a variance is the mean of the squares, of 15 stops of 3 axes known within
// sqrt(2 / 45), 21 %. The recursion begins with the information of 4 stops, and may differ by twice
// that from the batch with these four added.
TEST(DriveScaleAfterFifteenStops, AgreesWithTheMeanOfTheSquares) {
  constexpr double kPriorStops = 4.0;
  for (const double truth : {1.0, 3.0, 10.0}) {
    Scale scale;
    const double batch = play(scale, 15, truth, 1.0);
    const double expected = std::max(1.0, (15.0 * batch + kPriorStops) / (15.0 + kPriorStops));
    EXPECT_NEAR(std::log(double{scale.scale()} / expected), 0.0, 0.42) << truth;
  }
}

TEST(DriveScaleOfABiasThatMovesLessThanPredicted, StaysOne) {
  Scale scale;
  play(scale, 40, 0.1, 1.0);
  EXPECT_EQ(scale.scale(), 1.0F);
}

// A stop of three axes has the information 1.5 of the 30 that are remembered: the estimate of the
// logarithm follows with the gain 1/20 a score whose variance is 1 / 1.5, and has itself the
// deviation 0.13. What is above 1 of such an estimate is 0.4 times that on average, 0.052; were the
// estimate never below 1, it would be 0.8 times. 2,000 stops are 100 independent estimates: four
// standard errors.
TEST(DriveScaleOfABiasThatMovesAsPredicted, IsOneWithinItsError) {
  constexpr int kStops = 2000;
  Scale scale;
  double above = 0.0;
  for (int stop = 0; stop < kStops; ++stop) {
    play(scale, 1, 1.0, 1.0, stop);
    above += double{scale.scale()} - 1.0;
  }
  EXPECT_NEAR(above / kStops, 0.052, 4.0 * 0.58 * 0.13 / 10.0);
}

// The way up from the least estimate is ten stops long.
TEST(DriveScaleOfABiasThatMovedLessAtFirst, RisesInTenStops) {
  Scale scale;
  play(scale, 40, 0.1, 1.0);
  play(scale, 10, 10.0, 1.0, 40);
  EXPECT_GT(scale.scale(), 1.5F);
}

TEST(DriveScaleOfStopsThatTellNothing, Stays) {
  Scale scale;
  play(scale, 40, 3.0, 1e-3);
  EXPECT_NEAR(double{scale.scale()}, 1.0, 0.05);
}

TEST(DriveScaleOfOneWildStop, RisesByABoundedFactor) {
  Scale scale;
  play(scale, 40, 1.0, 1.0);
  const float before = scale.scale();
  scale.begin_stop(biases({}, kBefore), {});
  scale.end_stop(biases({1.0F, 1.0F, 1.0F}, 0.0F));
  // 3 x (16 - 1) / 2 over the most information.
  EXPECT_NEAR(double{scale.scale() / before}, 1.0 + 22.5 / 30.0, 0.02);
}

TEST(DriveScaleOfABiasThatJumps, IsExceededButNeverByChance) {
  for (const double truth : {0.5, 1.0, 1.5}) {
    Scale scale;
    for (int stops = 0; stops < 20; ++stops) {
      play(scale, 20, truth, 1.0);
      EXPECT_FALSE(scale.is_exceeded()) << truth;
    }
  }
  Scale scale;
  play(scale, 14, 30.0, 1.0);
  EXPECT_TRUE(scale.is_exceeded());
}

TEST(DriveScaleOfALongStop, LooksAtItsFirstTicksOnly) {
  Scale scale;
  scale.begin_stop(biases({}, kBefore), {});
  for (int tick = 0; tick < 19; ++tick) {
    scale.on_tick(biases({1e-4F, 1e-4F, 1e-4F}, 0.5F * kBefore));
    EXPECT_EQ(scale.scale(), 1.0F) << tick;
  }
  scale.on_tick(biases({1e-4F, 1e-4F, 1e-4F}, 0.5F * kBefore));
  const float judged = scale.scale();
  EXPECT_GT(judged, 1.0F);
  scale.end_stop(biases({1.0F, 1.0F, 1.0F}, 0.0F));
  EXPECT_EQ(scale.scale(), judged);
}

}  // namespace
}  // namespace zerorate::core
