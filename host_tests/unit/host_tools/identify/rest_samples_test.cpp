#include "host_tools/lib/identify/rest_samples.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "host_tests/support/folders.hpp"
#include "host_tools/lib/recording/error.hpp"

namespace zerorate::identify {
namespace {

using core::Duration;
using core::Instant;

/// Ten rows a second; the cell after the rate as `last` gives it for each row.
template <class Last>
std::string rows(const std::string& header, int count, Last last) {
  std::string text = header + "\n";
  for (int k = 0; k < count; ++k) {
    text += std::to_string(k / 10) + "." + std::to_string(k % 10) + "," + std::to_string(k) + "," +
            last(k) + "\n";
  }
  return text;
}

RestSamples read(const std::string& text, bool has_no_odometer = false) {
  const zerorate::testing::ScratchFolder folder;
  recording::Reader reader{folder.write("run.csv", text)};
  return read_rest_samples(reader, {.standstill = {.settle = Duration::seconds(1),
                                                   .hold_back = Duration::milliseconds(500)},
                                    .has_no_odometer = has_no_odometer});
}

TEST(RestSamplesWithoutMotionColumn, AreAllRows) {
  const RestSamples samples = read("t_s,rate_dps\n0,1\n0.1,2\n0.2,3\n");
  EXPECT_EQ(samples.time.size(), 3U);
  EXPECT_EQ(samples.axis_count, 1U);
  EXPECT_EQ(samples.sample_period, Duration::milliseconds(100));
  EXPECT_EQ(samples.span(), Duration::milliseconds(200));
  EXPECT_EQ(samples.moving, 0U);
  EXPECT_THAT(samples.after_drives, ::testing::IsEmpty());
}

/// A gyro that flips between 1 and 2 deg/s, and before that gives `first` so many times.
RestSamples after_start(int wild, const std::string& first) {
  std::string text = "t_s,rate_dps\n";
  for (int k = 0; k < 200; ++k) {
    text += std::to_string(k) + "," + (k < wild ? first : k % 2 == 0 ? "1" : "2") + "\n";
  }
  return read(text);
}

TEST(RestSamplesOfAGyroThatStarts, LeaveOutWhatItDidNotMeasure) {
  EXPECT_EQ(after_start(8, "-900").wild, 8U);
  EXPECT_EQ(after_start(8, "-900").time.size(), 192U);
  EXPECT_EQ(after_start(8, "15").wild, 0U) << "14 standard deviations";
  EXPECT_EQ(after_start(1, "-900").wild, 0U) << "one alone";
  EXPECT_EQ(after_start(60, "-900").wild, 60U) << "equal rows";
  EXPECT_EQ(after_start(30, "1.5").wild, 30U) << "equal rows at the level of the others";
  EXPECT_EQ(after_start(15, "1.5").wild, 0U) << "equal by chance";
}

TEST(RestSamples, LeaveOutLostRatesAndPlaceTheirStamps) {
  const RestSamples samples = read("t_s,rate_dps\n0,1\n0.1,nan\n0.2,3\n0.2,4\n0.15,5\n0.3,6\n");
  EXPECT_EQ(samples.time.size(), 5U);
  EXPECT_EQ(samples.lost, 1U);
  EXPECT_EQ(samples.rows, 6U);
}

TEST(RestSamplesWithStillColumn, LeaveOutSettleTimeAndHoldBack) {
  // Moving in rows 50 to 69, that is, from 5.0 to 6.9 s.
  const RestSamples samples = read(rows(
      "t_s,rate_dps,still", 100, [](int k) { return std::string(k >= 50 && k < 70 ? "0" : "1"); }));
  std::vector<std::int64_t> tenths;
  for (const auto at : samples.time) tenths.push_back(at.ns() / 100'000'000);
  // From 1.0 s, a settle time after the start, to 4.5 s; from 7.9 s to the end.
  EXPECT_THAT(tenths, ::testing::SizeIs(36 + 21));
  EXPECT_EQ(tenths.front(), 10);
  EXPECT_EQ(tenths[35], 45);
  EXPECT_EQ(tenths[36], 79);
  EXPECT_EQ(tenths.back(), 99);
  EXPECT_EQ(samples.moving, 100U - 57U);
  EXPECT_THAT(samples.after_drives, ::testing::ElementsAre(36U));
}

TEST(RestSamplesWithAnOdometerThatIsNotUsed, AreAllRows) {
  const std::string chatter =
      rows("t_s,rate_dps,odometer_pulses", 100, [](int k) { return std::to_string(k / 2); });
  EXPECT_THROW((void)read(chatter), recording::DataError) << "no row at rest";
  EXPECT_EQ(read(chatter, true).time.size(), 100U);
  EXPECT_EQ(read(chatter, true).moving, 0U);
}

RestSamples read_with_pulses_in_row_50(int pulses) {
  return read(rows("t_s,rate_dps,odometer_pulses", 200,
                   [pulses](int k) { return std::to_string(k < 50 ? 7 : 7 + pulses); }));
}

TEST(RestSamplesWithOdometer, MoveWithEveryChangeOfTheCount) {
  const RestSamples samples = read_with_pulses_in_row_50(2);
  // Nothing from 4.6 to 5.9 s.
  EXPECT_EQ(samples.time.size(), 36U + 140U);
  EXPECT_THAT(samples.after_drives, ::testing::ElementsAre(36U));
}

TEST(RestSamplesWithOdometer, MayCreepAfterASinglePulse) {
  const RestSamples samples = read_with_pulses_in_row_50(1);
  // Nothing from 4.6 to 12.9 s.
  EXPECT_EQ(samples.time.size(), 36U + 70U);
  EXPECT_THAT(samples.after_drives, ::testing::ElementsAre(36U));
}

// The clock is set back by an hour while the vehicle moves; the rest before it counts all the same.
TEST(RestSamplesAroundAClockStep, KeepTheRestBeforeIt) {
  std::string text = "t_s,rate_dps,still\n";
  for (int k = 0; k < 300; ++k) {
    const int tenths = 40'000 + k - (k >= 150 ? 36'000 : 0);
    text += std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + "," +
            std::to_string(k) + (k >= 100 && k < 200 ? ",0\n" : ",1\n");
  }
  const RestSamples samples = read(text);
  // Without a second of settling at the start and after the drive, and half a second before it.
  EXPECT_EQ(samples.time.size(), 86U + 91U);
  EXPECT_THAT(samples.after_drives, ::testing::ElementsAre(86U));
}

TEST(OutliersOfRestSamples, AreFoundAndLeftOut) {
  std::string text = "t_s,rate_dps\n";
  for (int k = 0; k < 300; ++k) {
    const bool is_outlier = k == 40 || (k >= 200 && k < 203);
    text += std::to_string(k) + "," + (is_outlier ? "90" : k % 2 == 0 ? "1" : "2") + "\n";
  }
  const RestSamples samples = read(text);
  const auto outliers = find_outliers(samples);
  EXPECT_THAT(outliers, ::testing::ElementsAre(40U, 200U, 201U, 202U));
  EXPECT_EQ(without(samples, outliers).time.size(), 296U);
}

/// Four minutes of noise at 100 Hz, with values up to twice `wild` instead of some of them.
RestSamples with_wild(int first, int count, double wild) {
  RestSamples samples{.axis_count = 1, .mean_period = Duration::milliseconds(10)};
  for (int k = 0; k < 24'000; ++k) {
    const bool is_wild = k >= first && k < first + count;
    const double noise = std::sin(1e4 * std::sin(k + 1.0));
    samples.time.push_back(Instant::from_ns(k * std::int64_t{10'000'000}));
    samples.rate_rad_s.push_back(
        {static_cast<float>(is_wild ? wild * (1.0 + std::sin(3.0 * k)) : noise)});
  }
  return samples;
}

TEST(WildStretches, AreFoundWhereverTheyAre) {
  for (const int first : {0, 7'777, 23'970}) {
    for (const int count : {1, 30}) {
      const auto found = find_wild_stretches(with_wild(first, count, 3'000.0));
      ASSERT_FALSE(found.empty()) << first << ", " << count;
      EXPECT_LE(found.front(), static_cast<std::size_t>(first));
      EXPECT_GE(found.back(), static_cast<std::size_t>(std::min(24'000, first + count) - 1));
      EXPECT_LE(found.size(), 100U) << "two half seconds";
    }
  }
}

TEST(WildStretches, AreNoneInNoiseAStepOrADrift) {
  EXPECT_THAT(find_wild_stretches(with_wild(0, 0, 0.0)), ::testing::IsEmpty());
  RestSamples step = with_wild(0, 0, 0.0);
  for (std::size_t k = 0; k < step.time.size(); ++k) {
    step.rate_rad_s[k][0] += k < 12'000 ? 0.0F : 50.0F;
  }
  // The half second in which the step comes may belong to neither level.
  EXPECT_LE(find_wild_stretches(step).size(), 50U);
  RestSamples drift = with_wild(0, 0, 0.0);
  for (std::size_t k = 0; k < drift.time.size(); ++k) {
    drift.rate_rad_s[k][0] += 1e-3F * static_cast<float>(k);
  }
  EXPECT_THAT(find_wild_stretches(drift), ::testing::IsEmpty());
}

TEST(TickMeansOfRestSamples, AreAbsentWhereThereAreNoSamples) {
  const RestSamples samples = read("t_s,rate_dps\n0,1\n0.1,2\n0.2,3\n1,4\n1.1,6\n");
  const auto ticks = average_ticks(samples, Duration::milliseconds(500));
  ASSERT_EQ(ticks.size(), 2U);
  EXPECT_EQ(ticks[0].tick, 0U);
  EXPECT_EQ(ticks[0].samples, 3U);
  EXPECT_EQ(ticks[1].tick, 2U);
  EXPECT_EQ(ticks[1].samples, 2U);
  EXPECT_NEAR(ticks[1].rate_rad_s[0], 5.0 * 0.017453293, 1e-7);
}

TEST(LongestEvenSamples, EndAtAHole) {
  const RestSamples samples =
      read("t_s,rate_dps\n0,1\n0.1,2\n0.5,3\n0.601,4\n0.7,5\n0.802,6\n1.5,7\n");
  const EvenRecord record = longest_even_samples(samples, 0);
  ASSERT_EQ(record.rate_rad_s.size(), 4U);
  EXPECT_NEAR(record.rate_rad_s.front(), 3.0 * 0.017453293, 1e-7);
  EXPECT_NEAR(record.sample_period_s, 0.302 / 3.0, 1e-12);
}

TEST(LongestEvenTicks, EndAtAHole) {
  std::vector<TickMean> ticks;
  for (const std::uint32_t tick : {0U, 1U, 5U, 6U, 7U, 9U}) {
    ticks.push_back({.tick = tick, .samples = 1, .rate_rad_s = {static_cast<float>(tick)}});
  }
  const EvenRecord record = longest_even_ticks(ticks, Duration::seconds(2), 0);
  EXPECT_THAT(record.rate_rad_s, ::testing::ElementsAre(5.0, 6.0, 7.0));
  EXPECT_EQ(record.sample_period_s, 2.0);
}

TEST(RestSamplesOfADrive, AreRefused) {
  EXPECT_THROW((void)read(rows("t_s,rate_dps,still", 50, [](int) { return std::string("0"); })),
               recording::DataError);
}

}  // namespace
}  // namespace zerorate::identify
