#include "host_tools/lib/recording/findings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "host_tests/support/allocation_counter.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tools/lib/recording/number.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::recording {
namespace {

/// Every row read from a text, and the findings at its end.
struct Reading {
  std::vector<Row> rows;
  Findings findings;
};

Reading read(std::string_view text) {
  const zerorate::testing::ScratchFolder folder;
  Reader reader{folder.write("run.csv", text)};
  Reading reading;
  for (Row row; reader.next(row);) {
    reading.rows.push_back(row);
  }
  reading.findings = reader.findings();
  return reading;
}

TEST(LostRates, AreDeliveredFlaggedAndCounted) {
  const Reading reading =
      read("t_s,gx_dps,gy_dps,gz_dps\n0,1,nan,3\n1,1,,3\n2,1,2,-inf\n3,1,2,3\n");
  ASSERT_EQ(reading.rows.size(), 4);
  EXPECT_TRUE(std::isnan(reading.rows[0].rate_rad_s[1]));
  EXPECT_TRUE(std::isnan(reading.rows[1].rate_rad_s[1]));
  EXPECT_TRUE(std::isinf(reading.rows[2].rate_rad_s[2]));
  EXPECT_TRUE(reading.rows[3].findings.empty());
  EXPECT_EQ(reading.findings.count(Finding::rate_lost), 3);
  EXPECT_EQ(reading.findings.first_line(Finding::rate_lost), 2);
  EXPECT_EQ(reading.findings.rows(), 4);
}

TEST(LostTemperature, DoesNotSpoilTheRate) {
  const Reading reading = read("t_s,rate_dps,temp_c\n0,1,25\n1,1,\n");
  EXPECT_TRUE(reading.rows[1].findings.has(Finding::temperature_lost));
  EXPECT_FALSE(reading.rows[1].findings.has(Finding::rate_lost));
}

TEST(MeanAcceleration, IsDoubtedWhereItIsNotThatOfGravity) {
  const auto doubt = [](const std::string& unit, const std::string& size) {
    return doubt_of_acceleration(read("t_s,rate_dps,ax_" + unit + ",ay_" + unit + ",az_" + unit +
                                      "\n0,1,0,0,-" + size + "\n1,1," + size + ",0,0\n2,1,,0,9\n")
                                     .findings);
  };
  EXPECT_EQ(doubt("mps2", "9.5"), "");
  EXPECT_EQ(doubt("g", "1.02"), "");
  EXPECT_EQ(doubt("mps2", "1.02"),
            "acceleration of 1.02 m/s2 in the mean, where gravity is 9.8 m/s2 (g taken for m/s2?)");
  EXPECT_NE(doubt("g", "9.81").find("96.2 m/s2 in the mean"), std::string::npos);
  EXPECT_NE(doubt("g", "9.81").find("m/s2 taken for g?"), std::string::npos);
  EXPECT_NE(doubt("mps2", "0.01").find("gravity taken off?"), std::string::npos);
  EXPECT_EQ(doubt_of_acceleration(read("t_s,rate_dps\n0,1\n").findings), "");
}

TEST(RawCountsNamedAsDegrees, AreFlaggedAsImplausible) {
  const Reading reading = read("t_s,rate_dps\n0,3999\n1,32786\n");
  EXPECT_TRUE(reading.rows[0].findings.empty());
  EXPECT_TRUE(reading.rows[1].findings.has(Finding::rate_implausible));
}

TEST(GapOfAnHour, IsFlaggedAndMeasured) {
  const Reading reading = read("t_s,rate_dps\n0,1\n0.01,1\n0.02,1\n3600.02,1\n3600.03,1\n");
  EXPECT_TRUE(reading.rows[3].findings.has(Finding::gap));
  EXPECT_EQ(reading.findings.count(Finding::gap), 1);
  EXPECT_EQ(reading.findings.longest_interval_ns(), 3'600'000'000'000);
  EXPECT_EQ(reading.findings.longest_interval_line(), 5);
  EXPECT_EQ(reading.findings.median_interval_ns(), 10'000'000);
}

TEST(IntervalOfTenMedians, IsNoGapAndOneNanosecondMoreIs) {
  const Reading reading =
      read("t_s,rate_dps\n0,1\n0.01,1\n0.02,1\n0.12,1\n0.13,1\n0.230000001,1\n");
  EXPECT_FALSE(reading.rows[3].findings.has(Finding::gap));
  EXPECT_TRUE(reading.rows[5].findings.has(Finding::gap));
}

// Pairs 1 ms apart every 100 ms, and a hole of ten seconds: the median says 1 ms, the mean 50.
TEST(MeanInterval, CountsThePausesBetweenBurstsAndNoHoles) {
  std::string text = "t_s,rate_dps\n";
  for (int k = 0; k < 100; ++k) {
    const double burst_s = 0.1 * k + (k < 50 ? 0.0 : 10.0);
    text += std::to_string(burst_s) + ",1\n" + std::to_string(burst_s + 0.001) + ",1\n";
  }
  const Reading reading = read(text);
  EXPECT_EQ(reading.findings.median_interval_ns(), 1'000'000);
  // 100 short intervals and 98 pauses of 99 ms.
  EXPECT_EQ(reading.findings.mean_interval_ns(), (100 * 1'000'000LL + 98 * 99'000'000LL) / 198);
}

TEST(MeanInterval, OfASlowSensorIsItsPeriodWithoutGaps) {
  const Reading reading = read("t_s,rate_dps\n0,1\n1,1\n2,1\n3,1\n103,1\n104,1\n");
  EXPECT_EQ(reading.findings.mean_interval_ns(), 1'000'000'000);
}

TEST(TimesAtBothEndsOfTheClock, DoNotOverflow) {
  const Reading reading = read("t_s,rate_dps\n-2305843009,1\n4611686018,1\n");
  EXPECT_EQ(reading.findings.longest_interval_ns(), 6'917'529'027'000'000'000);
}

TEST(OdometerRunningBackwards, IsFlagged) {
  const Reading reading = read("t_s,rate_dps,odometer_pulses\n0,1,7\n1,1,7\n2,1,0\n3,1,1\n");
  EXPECT_TRUE(reading.rows[2].findings.has(Finding::odometer_backwards));
  EXPECT_EQ(reading.findings.count(Finding::odometer_backwards), 1);
}

TEST(EqualIntervals, HaveTheirExactMedian) {
  IntervalMedian median;
  EXPECT_EQ(median.value_ns(), 0);
  for (int i = 0; i < 1'000; ++i) {
    median.add(10'070'493);
  }
  EXPECT_EQ(median.value_ns(), 10'070'493);
}

// The median's bin is one sixteenth of an octave's lower edge wide: 6.25 % at most.
TEST(RandomIntervals, HaveAMedianWithinABinOfTheSortedOne) {
  std::mt19937_64 random{2};
  std::lognormal_distribution<double> interval_ns{15.0, 2.0};
  IntervalMedian median;
  std::vector<std::int64_t> seen;
  for (int i = 0; i < 3'000; ++i) {
    seen.push_back(std::max<std::int64_t>(1, std::llround(interval_ns(random))));
    median.add(seen.back());
    std::vector<std::int64_t> sorted = seen;
    const auto middle = sorted.begin() + (static_cast<std::ptrdiff_t>(sorted.size()) - 1) / 2;
    std::nth_element(sorted.begin(), middle, sorted.end());
    ASSERT_NEAR(static_cast<double>(median.value_ns()), static_cast<double>(*middle),
                0.0626 * static_cast<double>(*middle) + 1.0);
  }
}

TEST(EveryFinding, HasADescriptionOfItsOwn) {
  std::vector<std::string_view> descriptions;
  for (std::size_t i = 0; i < kFindingCount; ++i) {
    descriptions.push_back(description(static_cast<Finding>(i)));
  }
  std::sort(descriptions.begin(), descriptions.end());
  EXPECT_EQ(std::unique(descriptions.begin(), descriptions.end()), descriptions.end());
  EXPECT_EQ(std::count(descriptions.begin(), descriptions.end(), "unknown finding"), 0);
}

constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();

std::int64_t ns(std::string_view text) {
  const auto time = parse_fixed_point(text, 9);
  EXPECT_TRUE(time) << text;
  return time ? time->value : -1;
}

TEST(TimeInDecimals, IsExactToTheNanosecond) {
  EXPECT_EQ(ns("0.01"), 10'000'000);
  EXPECT_EQ(ns("0"), 0);
  EXPECT_EQ(ns("-0.000000001"), -1);
  EXPECT_EQ(ns("+1."), 1'000'000'000);
  EXPECT_EQ(ns(".5"), 500'000'000);
  EXPECT_EQ(ns("00000000000000000000000000012.5"), 12'500'000'000);
  EXPECT_EQ(ns("1700000000.123456789"), 1'700'000'000'123'456'789);
  EXPECT_EQ(ns("9223372036.854775807"), kLargest);
  EXPECT_EQ(ns("-9223372036.854775807"), -kLargest);
}

TEST(TimeWithExponent, IsExactToo) {
  EXPECT_EQ(ns("1e-3"), 1'000'000);
  EXPECT_EQ(ns("1.5E+3"), 1'500'000'000'000);
  EXPECT_EQ(ns("123456789e-9"), 123'456'789);
  EXPECT_EQ(ns("0.000000000000000000000000001e27"), 1'000'000'000);
  EXPECT_EQ(ns("0e999999999"), 0);
  EXPECT_EQ(ns("1e-999999999"), 0);
}

TEST(TimeFinerThanNanoseconds, RoundsHalfAwayFromZeroAndSaysSo) {
  EXPECT_EQ(ns("0.0000000014999999999999999999"), 1);
  EXPECT_EQ(ns("0.0000000015"), 2);
  EXPECT_EQ(ns("-0.0000000015"), -2);
  EXPECT_FALSE(parse_fixed_point("0.0000000015", 9)->exact);
  EXPECT_FALSE(parse_fixed_point("1.00000000000000000000000001", 9)->exact);
  EXPECT_TRUE(parse_fixed_point("1.00000000000000000000000000", 9)->exact);
}

TEST(TextThatIsNoTime, IsRefused) {
  for (const char* text : {"", ".", "-", "e5", "1e", "1e+", "1,5", "1.2.3", "nan", "inf", "0x10",
                           "1 2", "--1", "12:30:00", "9223372036.854775808", "1e10", "1e400"}) {
    EXPECT_FALSE(parse_fixed_point(text, 9)) << text;
  }
}

TEST(AnyNanosecondCount, ComesBackFromItsText) {
  std::mt19937_64 random{1};
  for (int i = 0; i < 10'000; ++i) {
    const int bits = static_cast<int>(random() % 63) + 1;
    const auto magnitude = static_cast<std::int64_t>(random() >> (64 - bits));
    const std::int64_t time_ns = random() % 2 == 0 ? magnitude : -magnitude;
    std::string text;
    append_seconds(text, time_ns);
    ASSERT_EQ(ns(text), time_ns) << text;
  }
}

TEST(SecondsText, HasNoTrailingZeros) {
  const auto text = [](std::int64_t time_ns) {
    std::string seconds;
    append_seconds(seconds, time_ns);
    return seconds;
  };
  EXPECT_EQ(text(0), "0");
  EXPECT_EQ(text(10'000'000), "0.01");
  EXPECT_EQ(text(-1), "-0.000000001");
  EXPECT_EQ(text(100'000'000'000), "100");
  EXPECT_EQ(text(std::numeric_limits<std::int64_t>::min()), "-9223372036.854775808");
}

TEST(RealNumber, IsReadWithSignAndExponent) {
  EXPECT_EQ(parse_real("-0.25"), -0.25);
  EXPECT_EQ(parse_real("+1e-3"), 1e-3);
  EXPECT_EQ(parse_real("4.5399999618530273"), 4.5399999618530273);
}

TEST(LostOrExcessiveNumber, IsNotFinite) {
  EXPECT_TRUE(std::isnan(parse_real("").value()));
  EXPECT_TRUE(std::isnan(parse_real("NaN").value()));
  EXPECT_EQ(parse_real("-inf"), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(parse_real("1e400"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(parse_real("1e-400"), 0.0);
}

TEST(TextThatIsNoNumber, IsRefused) {
  for (const char* text : {"abc", "1.5x", "0x1p3", "+-1", "1 2", "-", ".", "NA", "1,5"}) {
    EXPECT_FALSE(parse_real(text)) << text;
  }
}

TEST(ReaderPastItsHeader, AllocatesNothingHoweverLongTheRecording) {
  const zerorate::testing::ScratchFolder folder;
  std::string text = "t_s,gx_dps,gy_dps,gz_dps,note,temp_c\n";
  for (int i = 0; i < 100'000; ++i) {  // several times the reader's buffers
    text += std::to_string(i) + ".125,0.25,,-1e-3,\"a, b\",25.5\n";
  }
  Reader reader{folder.write("run.csv", text)};
  const support::AllocationCounter allocations;
  for (Row row; reader.next(row);) {
  }
  EXPECT_EQ(allocations.count(), 0);
  EXPECT_EQ(reader.findings().rows(), 100'000);
}

}  // namespace
}  // namespace zerorate::recording
