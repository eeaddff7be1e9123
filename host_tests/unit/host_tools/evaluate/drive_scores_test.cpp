/// @file
/// The ratio of two predictors' heading drifts and its interval.

#include "host_tools/lib/evaluate/drive_scores.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::evaluate {
namespace {

DriveScores scores_of(const std::vector<double>& drifts_rad) {
  DriveScores scores;
  for (const double drift_rad : drifts_rad) scores.add({.drift_rad = drift_rad, .sigma_rad = 1.0});
  return scores;
}

TEST(DriftRatio, IsThatOfTheRootMeanSquares) {
  const DriveScores scores = scores_of({1.0, -2.0, 3.0, 0.5, 1.0});
  const DriveScores baseline = scores_of({2.0, 2.0, -2.0, 1.0, 3.0});
  const auto ratio = drift_ratio(scores, baseline);
  EXPECT_DOUBLE_EQ(ratio.value, scores.heading_drift_rms_rad() / baseline.heading_drift_rms_rad());
  EXPECT_LT(ratio.lo, ratio.value);
  EXPECT_GT(ratio.hi, ratio.value);
}

// Drives differ by a factor of a hundred; drawn apart from each other the ratio would do so too.
TEST(DriftRatio, DrawsTheDrivesOfBothTogether) {
  const auto ratio =
      drift_ratio(scores_of({0.05, 0.5, 5.0, 0.1, 1.0}), scores_of({0.1, 1.0, 10.0, 0.2, 2.0}));
  EXPECT_NEAR(ratio.lo, 0.5, 1e-12);
  EXPECT_NEAR(ratio.hi, 0.5, 1e-12);
  EXPECT_EQ(in_words(ratio), "0.500 [0.500, 0.500]");
}

TEST(DriftRatio, OfFewerThanFiveDrivesIsNone) {
  const auto ratio = drift_ratio(scores_of({1.0, 2.0, 3.0, 4.0}), scores_of({1.0, 2.0, 3.0, 4.0}));
  EXPECT_TRUE(std::isnan(ratio.value));
  EXPECT_EQ(in_words(ratio), "-");
  EXPECT_EQ(in_words(drift_ratio({}, {})), "-");
}

// 200 sets of 60 drives whose true ratio is 1/2. The share of intervals that hold it is within four
// standard deviations, sqrt(0.95 0.05 / 200) each, of 0.95.
TEST(DriftRatio, HasAnIntervalThatHoldsTheTruth) {
  constexpr std::size_t kSets = 200;
  constexpr std::size_t kDrives = 60;
  const random::RandomStream stream{7};
  double held = 0.0;
  for (std::size_t set = 0; set < kSets; ++set) {
    const auto of_set = stream.substream(set);
    std::vector<double> own;
    std::vector<double> other;
    for (std::size_t i = 0; i < kDrives; ++i) {
      const auto number = static_cast<std::int64_t>(3 * i);
      const double common = of_set.normal(number);
      own.push_back(0.5 * (common + of_set.normal(number + 1)));
      other.push_back(common + of_set.normal(number + 2));
    }
    const auto ratio = drift_ratio(scores_of(own), scores_of(other));
    if (ratio.lo <= 0.5 && 0.5 <= ratio.hi) held += 1.0;
  }
  EXPECT_NEAR(held / kSets, 0.95, 4.0 * std::sqrt(0.95 * 0.05 / kSets));
}

}  // namespace
}  // namespace zerorate::evaluate
