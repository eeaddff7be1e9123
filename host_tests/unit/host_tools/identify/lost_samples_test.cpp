#include "host_tools/lib/identify/lost_samples.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <vector>

namespace zerorate::identify {
namespace {

/// Stamps of a sensor at 100 Hz without every sample that draws a number below `lost_of_1000`; the
/// share that went is counted.
struct ThinnedTrain {
  ThinnedTrain(std::int64_t samples, std::uint64_t lost_of_1000) {
    std::mt19937_64 random{17};
    for (std::int64_t k = 0; k < samples; ++k) {
      if (random() % 1000 >= lost_of_1000) times.push_back(core::Instant::from_ns(k * 10'000'000));
    }
    lost = 1.0 - static_cast<double>(times.size()) / static_cast<double>(samples);
  }

  std::vector<core::Instant> times;
  double lost = 0.0;
};

TEST(LostShareOfAnEvenTrain, IsZero) {
  const LostShare share = lost_share(ThinnedTrain(100'000, 0).times, false);
  EXPECT_EQ(share.by_intervals, 0.0);
  EXPECT_EQ(share.by_unevenness, 0.0);
  EXPECT_EQ(share.mean_interval, core::Duration::milliseconds(10));
}

/// The unevenness is rather too small: the smallest of three estimates is taken.
TEST(LostShare, IsTheShareOfTheSamplesThatWentMissing) {
  for (const std::uint64_t lost_of_1000 : {50U, 150U, 300U}) {
    const ThinnedTrain train(400'000, lost_of_1000);
    const LostShare share = lost_share(train.times, false);
    EXPECT_NEAR(share.by_intervals, train.lost, 0.01);
    EXPECT_GT(share.by_unevenness, 0.6 * train.lost);
    EXPECT_LT(share.by_unevenness, 1.2 * train.lost);
    EXPECT_GT(share.most_by_unevenness, share.by_unevenness);
    EXPECT_LE(share.certain(), share.by_intervals);
    EXPECT_LE(share.certain(), share.most_by_unevenness);
  }
}

/// Stamps as the reader spreads those of bursts: evenly up to the next one.
std::vector<core::Instant> in_bursts(const std::vector<core::Instant>& times, std::size_t size,
                                     std::uint64_t jitter_ns) {
  std::mt19937_64 random{19};
  std::vector<core::Instant> read;
  const auto stamp_ns = [&](std::size_t k) {
    return times[k].ns() + static_cast<std::int64_t>(random() % jitter_ns);
  };
  std::int64_t from_ns = stamp_ns(0);
  for (std::size_t k = size; k < times.size(); k += size) {
    const std::int64_t to_ns = stamp_ns(k);
    const std::int64_t interval_ns = (to_ns - from_ns) / static_cast<std::int64_t>(size);
    for (std::size_t i = 0; i < size; ++i)
      read.push_back(core::Instant::from_ns(from_ns + static_cast<std::int64_t>(i) * interval_ns));
    from_ns = to_ns;
  }
  return read;
}

/// The variance of n bursts has a relative error of the root of 2/n: 0.1 of 195 bursts of 512, and
/// less of shorter ones. Four of these are allowed.
TEST(LostShareOfBursts, IsTheShareThatWentMissing) {
  for (const std::size_t size : {8U, 40U, 150U, 512U}) {
    const ThinnedTrain train(125'000, 200);
    const LostShare share = lost_share(in_bursts(train.times, size, 1), true);
    EXPECT_EQ(share.by_intervals, 0.0) << "the reader made the intervals";
    EXPECT_NEAR(share.by_unevenness, train.lost, 0.4 * train.lost) << size;
  }
}

/// Jitter of 20 ms adds 2 * 20^2 / 12 / 10^2 / 1024 = 0.0007 in the longest blocks.
TEST(LostShareOfBursts, IsNearZeroWhereTheyAreReadLate) {
  const ThinnedTrain train(125'000, 0);
  EXPECT_LT(lost_share(in_bursts(train.times, 20, 20'000'000), true).certain(), 0.005);
}

TEST(LostShareOfAJitteryClock, IsNearZero) {
  std::mt19937_64 random{18};
  std::vector<core::Instant> times;
  for (std::int64_t k = 0; k < 100'000; ++k) {
    const auto late_ns = static_cast<std::int64_t>(random() % 4'000'000);
    times.push_back(core::Instant::from_ns(k * 10'000'000 + late_ns));
  }
  EXPECT_LT(lost_share(times, false).certain(), 0.01);
}

TEST(LostShareOfAShortRecording, IsNotJudged) {
  const std::vector<core::Instant> times = ThinnedTrain(2'700, 300).times;
  ASSERT_LE(times.size(), 2'048U);
  EXPECT_EQ(lost_share(times, false).by_unevenness, 0.0);
  EXPECT_GT(lost_share(times, true).by_unevenness, 0.0) << "1024 in bursts are enough";
}

}  // namespace
}  // namespace zerorate::identify
