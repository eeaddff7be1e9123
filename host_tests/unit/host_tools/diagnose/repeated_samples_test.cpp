#include "host_tools/lib/diagnose/record/arrivals.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host_tools/lib/diagnose/record/even_series.hpp"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::size_t kSize = 5000;

/// White noise of unit size on levels so far apart; 0: on none.
Record noise_record(double step) {
  const random::RandomStream noise{11};
  Record record{.axis = "rate", .sample_period_s = 0.01};
  for (std::size_t k = 0; k < kSize; ++k) {
    const double value = noise.normal(static_cast<std::int64_t>(k));
    record.time_s.push_back(0.01 * static_cast<double>(k));
    record.rate_rad_s.push_back(step > 0.0 ? step * std::round(value / step) : value);
  }
  return record;
}

void hold(Record& record, std::size_t first, std::size_t count) {
  for (std::size_t k = first; k < first + count; ++k) {
    record.rate_rad_s[k] = record.rate_rad_s[first - 1];
  }
}

TEST(SamplesThatRepeatTheOneBefore, AreFoundAndCountAsLost) {
  Record record = noise_record(0.0);
  std::vector<std::size_t> held;
  for (std::size_t first = 100; first + 100 < kSize; first += 500) {
    hold(record, first, 2);
    held.insert(held.end(), {first, first + 1});
  }
  EXPECT_EQ(find_repeated_samples(record), held);
  const EvenSeries series = even_series_of(record);
  EXPECT_EQ(series.size(), kSize);
  EXPECT_EQ(series.losses.lost, held.size());
  EXPECT_EQ(series.losses.repeated, held.size());
  EXPECT_TRUE(series.lost[100]);
}

// Steps of 0.02 sigma: neighbours are equal by chance 0.02 / sqrt(4 pi) of the time, 28 of 5000.
TEST(SamplesThatRepeatTheOneBefore, AreFoundIfRareByChance) {
  Record record = noise_record(0.02);
  EXPECT_TRUE(find_repeated_samples(record).empty());
  for (std::size_t first = 10; first < kSize; first += 20) hold(record, first, 1);
  EXPECT_GE(find_repeated_samples(record).size(), 249U);
}

TEST(RecordsOnLevels, RepeatByChance) {
  for (const double step : {0.0, 0.01, 0.1, 0.5, 1.0, 3.0}) {
    EXPECT_TRUE(find_repeated_samples(noise_record(step)).empty()) << step;
  }
}

// A ramp over many coarse levels: most neighbours are equal, none was lost.
TEST(RecordsOnLevels, RepeatByChanceWhereTheyRiseToo) {
  Record record = noise_record(0.0);
  for (std::size_t k = 0; k < kSize; ++k) {
    record.rate_rad_s[k] =
        4.0 * std::round(0.25 * record.rate_rad_s[k] + 0.005 * static_cast<double>(k));
  }
  EXPECT_TRUE(find_repeated_samples(record).empty());
}

// Steps of a third of sigma, less a bias that is estimated anew every 50 samples: 9 % of the
// neighbours are equal by chance, and the least difference is that of two estimates.
TEST(RecordsOnLevels, RepeatByChanceWhereTheirBiasWasTakenOff) {
  const random::RandomStream estimates{12};
  for (const bool single_precision : {false, true}) {
    Record record = noise_record(0.32);
    for (std::size_t k = 0; k < kSize; ++k) {
      double& rate = record.rate_rad_s[k];
      rate -= 7.0 + 0.01 * estimates.normal(static_cast<std::int64_t>(k / 50));
      if (single_precision) rate = static_cast<double>(static_cast<float>(rate));
    }
    EXPECT_TRUE(find_repeated_samples(record).empty()) << single_precision;
    for (std::size_t first = 10; first < kSize; first += 2) hold(record, first, 1);
    EXPECT_GE(find_repeated_samples(record).size(), kSize / 2 - 10) << single_precision;
  }
}

TEST(RecordsThatEndAtAValue, RepeatItAndLoseNothing) {
  Record record = noise_record(0.0);
  for (double& rate : record.rate_rad_s) rate = std::min(rate, 1.2);
  EXPECT_TRUE(find_repeated_samples(record).empty());
}

}  // namespace
}  // namespace zerorate::diagnose
