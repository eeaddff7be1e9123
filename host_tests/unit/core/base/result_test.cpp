#include "core/base/result.hpp"

#include <gtest/gtest.h>

namespace zerorate::core {
namespace {

enum class Refusal : unsigned char { empty, late };

Result<int, Refusal> half_of_even(int x) {
  if (x % 2 != 0) return Unexpected{Refusal::late};
  return x / 2;
}

TEST(ResultWithValue, GivesTheValueAndNoError) {
  const auto result = half_of_even(8);
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(*result, 4);
  EXPECT_EQ(result.value_or(-1), 4);
}

TEST(ResultWithError, GivesTheErrorAndTheFallback) {
  const auto result = half_of_even(7);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error(), Refusal::late);
  EXPECT_EQ(result.value_or(-1), -1);
}

TEST(ResultWithError, ReadingTheValueIsAProgrammerError) {
  const auto result = half_of_even(7);
  EXPECT_DEATH((void)result.value(), "");
}

TEST(ResultOfVoid, IsSuccessUnlessToldOtherwise) {
  const Result<void, Refusal> fine;
  const Result<void, Refusal> refused = Unexpected{Refusal::empty};
  EXPECT_TRUE(fine.has_value());
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error(), Refusal::empty);
}

static_assert(sizeof(Result<void, Refusal>) == 2);

}  // namespace
}  // namespace zerorate::core
