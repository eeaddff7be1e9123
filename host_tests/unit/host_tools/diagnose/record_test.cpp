#include "host_tools/lib/diagnose/record/even_series.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/fit_data.hpp"
#include "host_tools/lib/diagnose/record/level_lattice.hpp"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::diagnose {
namespace {

Record steady(std::size_t size, double period_s) {
  Record record{.axis = "rate", .sample_period_s = period_s};
  for (std::size_t k = 0; k < size; ++k) {
    record.time_s.push_back(period_s * static_cast<double>(k));
    record.rate_rad_s.push_back(static_cast<double>(k));
  }
  return record;
}

void lose(Record& record, std::size_t first, std::size_t count) {
  const auto cut = [&](std::vector<double>& values) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first);
    values.erase(begin, begin + static_cast<std::ptrdiff_t>(count));
  };
  cut(record.time_s);
  cut(record.rate_rad_s);
}

// Ten samples a second, a drive from 30 to 70 s: what is left out of it was never lost.
TEST(RecordOfARecordingWithADrive, IsTheLongestStandstill) {
  identify::RestSamples samples{.sample_period = core::Duration::milliseconds(100),
                                .after_drives = {300}};
  for (int k = 0; k < 1500; ++k) {
    if (k >= 300 && k < 700) continue;
    samples.time.push_back(core::Instant::from_ns(std::int64_t{k} * 100'000'000));
    samples.rate_rad_s.push_back({static_cast<float>(k), 0.0F, 0.0F});
  }
  const Record record = record_of(samples, 0);
  EXPECT_EQ(record.standstills, 2U);
  ASSERT_EQ(record.size(), 800U);
  EXPECT_DOUBLE_EQ(record.time_s.front(), 70.0);
  EXPECT_DOUBLE_EQ(record.rate_rad_s.back(), 1499.0);
  EXPECT_EQ(even_series_of(record).losses.runs, 0U);
}

TEST(SeriesOfASteadyRecord, IsTheRecord) {
  const EvenSeries series = even_series_of(steady(1000, 0.01));
  EXPECT_EQ(series.rate_rad_s, steady(1000, 0.01).rate_rad_s);
  EXPECT_EQ(series.losses.lost, 0U);
  EXPECT_FALSE(series.is_ticks);
}

TEST(SeriesOfARecordWithLosses, BridgesThemByAStraightLine) {
  Record record = steady(1000, 0.01);
  lose(record, 700, 3);
  lose(record, 100, 1);
  const EvenSeries series = even_series_of(record);
  ASSERT_EQ(series.size(), 1000U);
  EXPECT_EQ(series.losses.lost, 4U);
  EXPECT_EQ(series.losses.runs, 2U);
  EXPECT_TRUE(series.lost[100]);
  EXPECT_NEAR(series.rate_rad_s[100], 100.0, 1e-9);
  EXPECT_NEAR(series.rate_rad_s[701], 701.0, 1e-9);
}

TEST(SeriesOfAJitteryRecord, LosesNothing) {
  Record record = steady(1000, 0.01);
  for (std::size_t k = 0; k < record.size(); ++k) {
    record.time_s[k] += 0.002 * std::sin(static_cast<double>(k * k));
  }
  const EvenSeries series = even_series_of(record);
  EXPECT_EQ(series.size(), 1000U);
  EXPECT_EQ(series.losses.lost, 0U);
  EXPECT_GT(series.losses.jitter, 0.1);
}

// With stamps off by a fifth of a period (rms) one interval in 250 is longer than 1.5 periods.
TEST(LossesOfAVeryJitteryRecord, AreOnlyWhatIsMissing) {
  Record record = steady(20'000, 0.01);
  std::vector<double> off(record.size());
  random::RandomStream(8).fill_normal(0, off);
  for (std::size_t k = 0; k < record.size(); ++k) {
    record.time_s[k] += 0.002 * std::clamp(off[k], -2.4, 2.4);
  }
  EXPECT_EQ(place_samples(record).losses.lost, 0U);
  for (const std::size_t first : {15'000U, 4000U}) lose(record, first, 7);
  const Losses losses = place_samples(record).losses;
  EXPECT_EQ(losses.lost, 14U);
  EXPECT_EQ(losses.expected, 20'000U);
}

TEST(LossesOfBatches, AreGapsAndNoShare) {
  Record record{.axis = "rate", .sample_period_s = 0.002};
  std::vector<double> off(20'000);
  random::RandomStream(8).fill_normal(0, off);
  double time_s = 0.0;
  for (std::size_t k = 0; k < off.size(); ++k) {
    time_s += 0.002 + 0.0005 * std::clamp(off[k], -3.0, 3.0) + (k % 10 == 9 ? 0.08 : 0.0);
    record.time_s.push_back(time_s);
    record.rate_rad_s.push_back(0.0);
  }
  const Losses losses = place_samples(record).losses;
  EXPECT_TRUE(losses.in_bursts);
  EXPECT_EQ(losses.lost, 0U);
  EXPECT_EQ(losses.runs, 2000U);
  EXPECT_NEAR(losses.gaps_s, 2000 * 0.082, 0.5);
}

TEST(SeriesOfARecordInBursts, HoldsMeansOverTicks) {
  Record record{.axis = "rate", .sample_period_s = 0.001};
  for (std::size_t burst = 0; burst < 2000; ++burst) {
    for (std::size_t i = 0; i < 10; ++i) {
      record.time_s.push_back(0.1 * static_cast<double>(burst) + 0.001 * static_cast<double>(i));
      record.rate_rad_s.push_back(static_cast<double>(i));
    }
  }
  const EvenSeries series = even_series_of(record);
  EXPECT_TRUE(series.is_ticks);
  EXPECT_TRUE(series.losses.is_uneven);
  EXPECT_GE(series.size(), 256U);
}

TEST(SeriesOfARecordWithALongHole, IsItsLongestStretch) {
  Record record = steady(1000, 0.01);
  lose(record, 300, 100);
  const EvenSeries series = even_series_of(record);
  EXPECT_EQ(series.size(), 600U);
  EXPECT_NEAR(series.start_s, 4.0, 1e-9);
}

std::vector<double> normal_values(std::size_t size) {
  std::vector<double> values(size);
  random::RandomStream(11).fill_normal(0, values);
  return values;
}

TEST(MeansOfASeries, AreThoseOfNeighboursAndLostWhereHalfOfThemAre) {
  const EvenSeries series{.period_s = 0.1,
                          .start_s = 2.0,
                          .rate_rad_s = {1.0, 2.0, 3.0, 4.0, 9.0},
                          .temperature_degc = {20.0, 21.0, 22.0, 24.0, 30.0},
                          .lost = {false, false, true, false, false}};
  const EvenSeries means = means_of(series, 2);
  EXPECT_DOUBLE_EQ(means.period_s, 0.2);
  EXPECT_DOUBLE_EQ(means.start_s, 2.05);
  EXPECT_EQ(means.rate_rad_s, (std::vector{1.5, 3.5}));
  EXPECT_EQ(means.temperature_degc, (std::vector{20.5, 23.0}));
  EXPECT_EQ(means.lost, (std::vector{false, true}));
}

TEST(LatticeOfRoundedValues, HasTheirStepAndCountsThem) {
  std::vector<double> values = normal_values(5000);
  for (double& value : values)
    value = double{static_cast<float>(7.0 + 0.125 * std::round(8.0 * value))};
  const auto lattice = find_lattice(values);
  ASSERT_TRUE(lattice);
  EXPECT_NEAR(lattice->step, 0.125, 1e-6);
  std::size_t counted = 0;
  for (const std::size_t count : lattice->counts) counted += count;
  EXPECT_EQ(counted, values.size());
}

TEST(LatticeOfNormalValues, IsNone) {
  EXPECT_FALSE(find_lattice(normal_values(5000)));
}

TEST(LatticeOfUnevenLevels, IsNone) {
  std::vector<double> values;
  for (int i = 0; i < 400; ++i) values.push_back(std::sqrt(static_cast<double>(i % 20)));
  EXPECT_FALSE(find_lattice(values));
}

TEST(Extremes, AreCounted) {
  const std::vector<double> values{1.0, 3.0, 3.0, 2.0, 3.0, 1.5};
  EXPECT_EQ(count_extremes(values).lowest, 1U);
  EXPECT_EQ(count_extremes(values).highest, 3U);
}

constexpr std::size_t kRepairSize = 20'000;

std::vector<double> white_noise() {
  std::vector<double> values(kRepairSize);
  random::RandomStream(3).fill_normal(0, values);
  return values;
}

TEST(RepairOfNothing, ChangesNothing) {
  const std::vector<double> values = white_noise();
  EXPECT_EQ(repair(values, std::vector<bool>(kRepairSize), {}, 1), values);
}

TEST(RepairedValues, HaveTheLevelAndTheSpreadOfTheirNeighbours) {
  constexpr double kLevel = 10.0;
  std::vector<double> values = white_noise();
  std::vector<bool> is_replaced(kRepairSize);
  for (std::size_t k = 0; k < kRepairSize; ++k) {
    values[k] += kLevel;
    is_replaced[k] = k % 20 < 4;
    if (is_replaced[k]) values[k] = 1e6;
  }
  const std::vector<double> repaired = repair(values, is_replaced, {}, 1);
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t k = 0; k < kRepairSize; ++k) {
    if (!is_replaced[k]) {
      EXPECT_EQ(repaired[k], values[k]);
      continue;
    }
    sum += repaired[k] - kLevel;
    squares += (repaired[k] - kLevel) * (repaired[k] - kLevel);
    count += 1.0;
  }
  // 1,000 bridges between means of eight values, with noise of variance 1: a bridge has a variance
  // of 1/8 to 1/16, and the values of one share it.
  EXPECT_NEAR(sum / count, 0.0, 5.0 * std::sqrt(1.0 / count + 0.125 / 1000.0));
  EXPECT_NEAR(squares / count, 1.1, 5.0 * 1.1 * std::sqrt(2.0 / count) + 0.05);
}

TEST(RepairedValuesAtAnEndOfTheRange, LieBeyondIt) {
  std::vector<double> values = white_noise();
  std::vector<bool> is_replaced(kRepairSize);
  for (std::size_t k = 0; k < kRepairSize; ++k) {
    if (values[k] < 1.0) continue;
    values[k] = 1.0;
    is_replaced[k] = true;
  }
  const std::vector<double> repaired = repair(values, is_replaced, {.hi = 1.0}, 1);
  for (std::size_t k = 0; k < kRepairSize; ++k) {
    if (is_replaced[k]) {
      EXPECT_GE(repaired[k], 1.0) << k;
    }
  }
}

}  // namespace
}  // namespace zerorate::diagnose
