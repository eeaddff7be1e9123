#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "host_tests/support/folders.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::recording {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A recording of one axis whose rate counts its rows.
class Stamps {
 public:
  void add(double time_s) { add(time_s, count_++); }
  void add(double time_s, int rate) {
    text_ += std::to_string(time_s) + "," + std::to_string(rate) + "\n";
  }
  void add_even(double from_s, double period_s, int count) {
    for (int k = 0; k < count; ++k) add(from_s + period_s * k);
  }

  struct Reading {
    std::vector<double> time_s;
    std::vector<long> rates;
    Findings findings;
  };
  [[nodiscard]] Reading read(const Layout& layout = {}) const {
    const zerorate::testing::ScratchFolder folder;
    Input input{folder.write("run.csv", "t_s,rate_dps\n" + text_)};
    input.layout = layout;
    Reader reader{input};
    Reading reading;
    for (Row row; reader.next(row);) {
      reading.time_s.push_back(static_cast<double>(row.time_ns) * 1e-9);
      reading.rates.push_back(std::lround(row.rate_rad_s[0] * 57.29577951308232));
    }
    reading.findings = reader.findings();
    return reading;
  }
  [[nodiscard]] std::string complaint() const {
    try {
      static_cast<void>(read());
    } catch (const DataError& error) {
      return error.what();
    }
    return "";
  }

 private:
  std::string text_;
  int count_ = 0;
};

TEST(CounterOf32BitsOfMicroseconds, CountsOn) {
  Stamps stamps;
  stamps.add_even(4294.0, 0.1, 10);
  stamps.add_even(0.032704, 0.1, 10);
  const auto reading = stamps.read();
  ASSERT_EQ(reading.time_s.size(), 20U);
  EXPECT_NEAR(reading.time_s[10], 4295.0, 1e-9);
  EXPECT_NEAR(reading.time_s[19], 4295.9, 1e-9);
  EXPECT_EQ(reading.findings.count(Finding::counter_wrapped), 1U);
  EXPECT_EQ(reading.findings.count(Finding::clock_step), 0U);
}

TEST(CounterOfAnotherUnit, CountsOnFromItsEndToZero) {
  // 2^16 counts of 25 us and of 1/32768 s, 2^24 of 39.0625 us, 31 bits of us, the second, the day.
  for (const double range_s : {1.6384, 2.0, 655.36, 2147.483648, 1.0, 86'400.0}) {
    Stamps stamps;
    for (int k = 0; k < 3'000; ++k) stamps.add(std::fmod(range_s - 0.501 + 0.01 * k, range_s));
    const auto reading = stamps.read();
    ASSERT_EQ(reading.time_s.size(), 3'000U);
    EXPECT_NEAR(reading.time_s.back() - reading.time_s.front(), 29.99, 1e-4) << range_s;
    EXPECT_EQ(reading.findings.count(Finding::clock_step), 0U) << range_s;
  }
}

TEST(CounterReadInBursts, CountsOn) {
  constexpr double kRange_s = 65.536;
  constexpr int kBurst = 20;
  Stamps stamps;
  for (int k = 0; k < 1'000; ++k) {
    for (int i = 0; i < kBurst; ++i) stamps.add(std::fmod(60.0 + 0.2 * k, kRange_s));
  }
  const auto reading = stamps.read();
  ASSERT_EQ(reading.time_s.size(), 20'000U);
  EXPECT_NEAR(reading.time_s.back() - reading.time_s.front(), 199.99, 0.02);
  EXPECT_EQ(reading.findings.count(Finding::clock_step), 0U);
}

TEST(ClockSetBack, GoesOnAfterAPause) {
  Stamps stamps;
  stamps.add_even(7200.0, 0.1, 100);
  stamps.add_even(3600.0, 0.1, 100);
  const auto reading = stamps.read();
  ASSERT_EQ(reading.time_s.size(), 200U);
  EXPECT_NEAR(reading.time_s[100] - reading.time_s[99], 2.0, 1e-9);
  EXPECT_NEAR(reading.time_s[199] - reading.time_s[100], 9.9, 1e-9);
  EXPECT_EQ(reading.findings.count(Finding::clock_step), 1U);
  EXPECT_EQ(reading.findings.first_line(Finding::clock_step), 102U);
}

TEST(LeapSecond, IsNotMixedWithTheSecondAfterIt) {
  for (const double back_s : {0.5, 1.0, 1.5}) {
    Stamps stamps;
    stamps.add_even(100.0, 0.1, 30);
    stamps.add_even(103.0 - back_s, 0.1, 30);
    const auto reading = stamps.read();
    EXPECT_EQ(reading.findings.count(Finding::clock_step), 1U) << back_s;
    EXPECT_EQ(reading.findings.count(Finding::time_sorted), 0U) << back_s;
    for (std::size_t k = 0; k < 60; ++k) EXPECT_EQ(reading.rates[k], static_cast<long>(k));
  }
}

TEST(BufferThatIsWrittenTwice, CountsOnce) {
  Stamps stamps;
  stamps.add_even(100.0, 0.1, 30);
  for (int k = 22; k < 30; ++k) stamps.add(100.0 + 0.1 * k, k);
  for (int k = 30; k < 60; ++k) stamps.add(100.0 + 0.1 * k, k);
  const auto reading = stamps.read();
  EXPECT_EQ(reading.findings.count(Finding::clock_step), 0U);
  EXPECT_EQ(reading.rates.size(), 60U);
}

TEST(RowThatCameLate, StandsWhereItsStampBelongs) {
  Stamps stamps;
  for (const double time_s : {0.0, 0.1, 0.3, 0.4, 0.2, 0.5}) stamps.add(time_s);
  const auto reading = stamps.read();
  EXPECT_THAT(reading.rates, ElementsAre(0, 1, 4, 2, 3, 5));
  EXPECT_EQ(reading.findings.count(Finding::time_sorted), 1U);
}

TEST(BlocksOutOfOrder, AreSorted) {
  Stamps stamps;
  stamps.add_even(0.0, 0.1, 500);
  stamps.add_even(150.0, 0.1, 1000);
  stamps.add_even(50.0, 0.1, 1000);
  stamps.add_even(250.0, 0.1, 500);
  const auto reading = stamps.read();
  ASSERT_EQ(reading.time_s.size(), 3000U);
  for (int k = 0; k < 3000; ++k)
    ASSERT_NEAR(reading.time_s[static_cast<std::size_t>(k)], 0.1 * k, 1e-6) << k;
  EXPECT_EQ(reading.findings.count(Finding::clock_step), 0U);
}

TEST(StrayStamp, IsLeftOut) {
  for (const double stray_s : {-5.0e8, 1.7e9}) {
    Stamps stamps;
    stamps.add_even(100.0, 0.1, 50);
    stamps.add(stray_s);
    stamps.add_even(105.1, 0.1, 50);
    const auto reading = stamps.read();
    EXPECT_EQ(reading.time_s.size(), 100U);
    EXPECT_EQ(reading.findings.count(Finding::time_stray), 1U);
    EXPECT_EQ(reading.findings.first_line(Finding::time_stray), 52U);
    EXPECT_EQ(reading.findings.count(Finding::gap), 0U);
  }
}

// A later stamp that strays as well lies beyond the first.
TEST(StrayStamps, AreLeftOutOneBesideTheOther) {
  Stamps stamps;
  stamps.add_even(100.0, 0.1, 500);
  stamps.add(46'140.0);
  stamps.add_even(150.1, 0.1, 1'000);
  stamps.add(56'863.0);
  stamps.add_even(250.2, 0.1, 500);
  const auto reading = stamps.read();
  EXPECT_EQ(reading.time_s.size(), 2'000U);
  EXPECT_EQ(reading.findings.count(Finding::time_stray), 2U);
  EXPECT_EQ(reading.findings.count(Finding::clock_step), 0U);
}

TEST(StrayStamp, IsLeftOutWhereTheCounterBeginsAgain) {
  constexpr double kRange_s = 16.777216;  // 2^24 microseconds
  Stamps stamps;
  stamps.add_even(10.0, 0.01, 677);  // up to 16.76
  stamps.add(210'668.0);
  for (int k = 0; k < 3'000; ++k) stamps.add(std::fmod(16.78 + 0.01 * k, kRange_s));
  const auto reading = stamps.read();
  ASSERT_EQ(reading.time_s.size(), 3'677U);
  EXPECT_EQ(reading.findings.count(Finding::time_stray), 1U);
  EXPECT_EQ(reading.findings.count(Finding::time_sorted), 0U);
  EXPECT_NEAR(reading.time_s.back(), 10.0 + 6.78 + 0.01 * 2'999, 1e-6);
}

TEST(SamplesThatShareAStamp, AreSpreadEvenly) {
  Stamps stamps;
  for (int second = 0; second < 20; ++second) {
    for (int k = 0; k < 5; ++k) stamps.add(second);
  }
  const auto reading = stamps.read();
  for (int k = 0; k < 100; ++k)
    ASSERT_NEAR(reading.time_s[static_cast<std::size_t>(k)], 0.2 * k, 1e-6) << k;
  EXPECT_EQ(doubt_of_rows(reading.findings), "the time stamps of 81 % of the rows were repaired");
}

TEST(RowThatIsWrittenTwice, CountsOnce) {
  Stamps stamps;
  stamps.add_even(0.0, 0.1, 50);
  stamps.add(4.9, 49);
  stamps.add(5.0, 50);
  const auto reading = stamps.read();
  EXPECT_EQ(reading.time_s.size(), 51U);
  EXPECT_EQ(reading.findings.count(Finding::row_repeated), 1U);
  EXPECT_EQ(doubt_of_rows(reading.findings), "1.9 % of the rows were not used");
}

TEST(StampsWithoutTheirDigits, AreRefusedUnlessTheRateIsGiven) {
  Stamps stamps;
  for (int k = 0; k < 100; ++k) stamps.add(1.73234e9);
  EXPECT_THAT(stamps.complaint(), HasSubstr("digits were lost"));
  EXPECT_THAT(stamps.complaint(), HasSubstr("--rows-at"));
  const auto reading = stamps.read({.rows_at_hz = 50.0});
  EXPECT_NEAR(reading.time_s[99], 1.98, 1e-9);
}

TEST(TwoClocksInTurn, AreRefused) {
  Stamps stamps;
  for (int k = 0; k < 20'000; ++k) stamps.add(0.1 * k + (k % 2 == 0 ? 0.0 : 1e6));
  EXPECT_THAT(stamps.complaint(), HasSubstr("--where"));
}

/// Rows whose stamps are those of these functions of the row's number.
std::string complaint_of(double (*stamp_s)(int)) {
  Stamps stamps;
  for (int k = 0; k < 6'000; ++k) stamps.add(stamp_s(k));
  return stamps.complaint();
}

TEST(TwoSensorsInTurn, AreRefusedWhereEachHasATimeLine) {
  constexpr const char* kReason = "each with a time line of its own";
  // Bursts of 20 rows of each, and rows of which one of three was lost.
  EXPECT_THAT(complaint_of([](int k) { return 0.2 * (k / 40) + (k % 2 == 0 ? 0.0 : 0.003); }),
              HasSubstr(kReason));
  EXPECT_THAT(complaint_of([](int k) {
                const int row = k + k / 2;
                return 0.2 * (row / 40) + (row % 2 == 0 ? 0.0 : 0.003);
              }),
              HasSubstr(kReason));
  // Two and three clocks that are 13 and 26 periods apart, and a bit.
  EXPECT_THAT(complaint_of([](int k) { return 0.01 * (k / 2) + (k % 2 == 0 ? 0.133 : 0.0); }),
              HasSubstr(kReason));
  EXPECT_THAT(complaint_of([](int k) { return 0.01 * (k / 3) + 0.132 * (k % 3); }),
              HasSubstr(kReason));
  EXPECT_THAT(complaint_of([](int k) { return 0.01 * (k / 2) + (k % 2 == 0 ? 8.0 : 0.0); }),
              HasSubstr(kReason));
}

TEST(CounterThatBeginsAgainInEachBurst, IsRefused) {
  EXPECT_THAT(complaint_of([](int k) { return std::fmod(2.54 * (k / 254), 4.294967296); }),
              HasSubstr("while a burst is read"));
}

TEST(PairsInTheWrongOrder, AreSorted) {
  EXPECT_EQ(complaint_of([](int k) { return 0.01 * (k % 2 == 0 ? k + 1 : k - 1); }), "");
  EXPECT_EQ(complaint_of([](int k) {
              return 0.01 * (k % 7 == 3 ? k + 1 : k % 7 == 4 ? k - 1 : k);
            }),
            "");
}

TEST(PeriodOfTheSamples, IsDoubtedWhereNoGyroHasIt) {
  EXPECT_EQ(doubt_of_period(1'000'000'000), "");
  EXPECT_EQ(doubt_of_period(31'250), "");
  EXPECT_THAT(doubt_of_period(10'000'000'000), HasSubstr("milliseconds named seconds"));
  EXPECT_THAT(doubt_of_period(10'000), HasSubstr("--rows-at 1e+05"));
}

TEST(FileOfAnAwkwardLogger, IsReadAsFarAsItIsWhole) {
  const zerorate::testing::ScratchFolder folder;
  const auto rows = [&](const std::string& text, const Layout& layout) {
    Input input{folder.write("run.csv", text)};
    input.layout = layout;
    Reader reader{input};
    std::vector<std::int64_t> times;
    for (Row row; reader.next(row);) times.push_back(row.time_ns);
    return times;
  };
  EXPECT_THAT(rows("t_s,rate_dps\n0,1\n1,1\n2", {}), ElementsAre(0, 1'000'000'000));
  EXPECT_THAT(rows("t_s,rate_dps\n0,1\n1,1\n" + std::string(512, '\0'), {}),
              ElementsAre(0, 1'000'000'000));
  for (const char* units : {"s,deg/s", "(sec),(deg/s)", ",[deg/s]"}) {
    EXPECT_THAT(rows(std::string("t_s,rate_dps\n") + units + "\n0,1\n1,1\n", {}),
                ElementsAre(0, 1'000'000'000));
  }
  EXPECT_THAT(rows("sep=,\nt_s,rate_dps\n0,1\n1,1\n \n", {}), ElementsAre(0, 1'000'000'000));
  EXPECT_THAT(rows("t_s,rate_dps\n0,1\n1,1\nt_s,rate_dps\n8,1\n9,1\n", {}),
              ElementsAre(0, 1'000'000'000, 8'000'000'000, 9'000'000'000));
  EXPECT_THAT(rows("a,b,c\nd\nt_s,rate_dps\n5,1\n", {.skipped_lines = 2}),
              ElementsAre(5'000'000'000));
  EXPECT_THAT(rows("t_s,gz_dps,I\n5,1,0\n5,1,1\n6,1,0\n", {.where = {{"I", "0"}}}),
              ElementsAre(5'000'000'000, 6'000'000'000));
  Layout stamps;
  stamps.set_columns("t=sec,t_ns=nsec");
  stamps.set_units("time=s");
  EXPECT_THAT(rows("sec,nsec,rate_dps\n5,250,1\n", stamps), ElementsAre(5'000'000'250));
  Layout timeval;
  timeval.set_columns("t=sec,t_us=usec");
  timeval.set_units("time=s");
  EXPECT_THAT(rows("sec,usec,rate_dps\n5,250,1\n", timeval), ElementsAre(5'000'250'000));
}

}  // namespace
}  // namespace zerorate::recording
