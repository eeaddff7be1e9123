#include "host_tools/lib/statistics/search_significance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace zerorate::statistics {
namespace {

TEST(SurpriseOfNoGain, IsNothing) {
  EXPECT_EQ(surprisal_of_free(0.0, 1.0), 0.0);
  EXPECT_EQ(surprisal_of_strength(0.0), 0.0);
  EXPECT_NEAR(surprisal_of_search(0.0, 1.0, 10.0), 0.0, 1e-12);
}

TEST(Surprise, IsTheLogarithmOfChiSquaredTails) {
  // 3.841 and 5.991: 95 % points of one and two degrees of freedom, from tables.
  EXPECT_NEAR(surprisal_of_free(0.5 * 3.841, 1.0), -std::log(0.05), 1e-3);
  EXPECT_NEAR(surprisal_of_free(0.5 * 5.991, 2.0), -std::log(0.05), 1e-3);
  EXPECT_NEAR(surprisal_of_strength(0.5 * 3.841), -std::log(0.025), 1e-3);
}

TEST(Surprise, IsContinuousWhereProbabilitiesUnderflow) {
  EXPECT_NEAR(surprisal_of_free(300.1, 1.0) - surprisal_of_free(299.9, 1.0), 0.2, 2e-3);
}

TEST(SurpriseOfASearch, PaysForTheLevelCrossings) {
  const double free = surprisal_of_search(30.0, 2.0, 0.0);
  EXPECT_NEAR(free - surprisal_of_search(30.0, 2.0, 99.0), std::log(100.0), 1e-9);
}

}  // namespace
}  // namespace zerorate::statistics
