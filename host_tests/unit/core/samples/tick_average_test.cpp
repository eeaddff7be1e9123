#include "core/samples/tick_average.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace zerorate::core {
namespace {

constexpr Duration kTick = Duration::milliseconds(100);
constexpr Duration kSample = Duration::milliseconds(10);

/// Feeds samples at these times and returns the means of the ticks they were sorted into.
std::vector<TickMean<1>> means_of(const std::vector<std::pair<Instant, float>>& samples) {
  TickAverage<1> average{kTick, kSample};
  std::vector<TickMean<1>> means;
  for (const auto& [at, rate] : samples) {
    if (average.is_over_at(at) && !average.is_empty()) means.push_back(average.close());
    average.enter(at);
    average.add(at, {rate});
  }
  return means;
}

TEST(TickAverage, MeansTheSamplesOfEachTick) {
  std::vector<std::pair<Instant, float>> samples;
  for (int k = 0; k < 30; ++k) {
    samples.emplace_back(Instant{} + kSample * k, static_cast<float>(k));
  }
  const auto means = means_of(samples);
  ASSERT_EQ(means.size(), 2U);
  EXPECT_EQ(means[0].samples, 10U);
  EXPECT_FLOAT_EQ(means[0].rate_rad_s[0], 4.5F);
  EXPECT_FLOAT_EQ(means[1].rate_rad_s[0], 14.5F);
  EXPECT_EQ(means[1].tick, 1U);
  EXPECT_EQ(means[1].end, Instant{} + kSample * 19);
}

TEST(TickAverageWithJitter, StillGivesEverySampleItsTick) {
  std::mt19937 random(9);
  std::uniform_int_distribution<std::int64_t> jitter_ns(-4'900'000, 4'900'000);
  std::vector<std::pair<Instant, float>> samples;
  for (int k = 0; k < 1001; ++k) {
    samples.emplace_back(
        Instant{} + kSample * k + Duration::nanoseconds(k == 0 ? 0 : jitter_ns(random)), 1.0F);
  }
  for (const auto& mean : means_of(samples)) EXPECT_EQ(mean.samples, 10U);
}

// 24.8 days of ticks of a millisecond; docs/reference/zerorated.md tells it of filter.rate_hz.
TEST(TickAverageOfMoreTicksThanACounterHolds, TakesNoFurtherSample) {
  constexpr Duration kMillisecond = Duration::milliseconds(1);
  TickAverage<1> average{kMillisecond, kMillisecond};
  average.enter(Instant{});
  constexpr std::int64_t kTicks = std::int64_t{1} << 31U;
  EXPECT_TRUE(average.can_take(Instant{} + kMillisecond * (kTicks - 1)));
  EXPECT_FALSE(average.can_take(Instant{} + kMillisecond * kTicks));
}

TEST(TickAverageWithAGap, NumbersTheNextTickByTheClock) {
  const auto means = means_of({{Instant{}, 1.0F},
                               {Instant{} + Duration::seconds(3600), 2.0F},
                               {Instant{} + Duration::seconds(3601), 3.0F}});
  ASSERT_EQ(means.size(), 2U);
  EXPECT_EQ(means[1].tick, 36'000U);
}

TEST(TickAverageUnderALargeRate, KeepsTheSmallDifferences) {
  const float one_ulp_more = std::nextafter(4.0F, 5.0F);
  std::vector<std::pair<Instant, float>> samples;
  for (int k = 0; k < 200; ++k) samples.emplace_back(Instant{} + kSample * k, one_ulp_more);
  for (const auto& mean : means_of(samples)) EXPECT_EQ(mean.rate_rad_s[0], one_ulp_more);
}

TEST(TickAverageGivenTimesItCannotCount, SaysSo) {
  TickAverage<1> average{kTick, kSample};
  EXPECT_TRUE(average.can_take(Instant::from_ns(-1)));
  average.enter(Instant{});
  EXPECT_FALSE(average.can_take(Instant::from_ns(-1'000'000'000)));
  EXPECT_FALSE(average.can_take(Instant{} + Duration::seconds(8LL * 365 * 86'400)));
}

}  // namespace
}  // namespace zerorate::core
