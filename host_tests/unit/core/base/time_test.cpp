#include "core/base/time.hpp"

#include <gtest/gtest.h>

namespace zerorate::core {
namespace {

TEST(InstantsOneDayApart, DifferByExactlyThatManyNanoseconds) {
  const Instant start = Instant::from_ns(1);
  const Instant end = start + Duration::seconds(86'400);
  EXPECT_EQ((end - start).ns(), 86'400'000'000'000);
  EXPECT_LT(start, end);
}

TEST(DurationQuotient, CountsWholePeriodsTowardsZero) {
  EXPECT_EQ(Duration::milliseconds(29) / Duration::milliseconds(10), 2);
  EXPECT_EQ(Duration::milliseconds(-29) / Duration::milliseconds(10), -2);
}

TEST(DurationInSeconds, IsSinglePrecision) {
  EXPECT_FLOAT_EQ(Duration::microseconds(9'615).in_seconds(), 0.009615F);
}

}  // namespace
}  // namespace zerorate::core
