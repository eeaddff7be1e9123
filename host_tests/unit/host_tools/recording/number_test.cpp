#include "host_tools/lib/recording/number.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>

#include "host_tests/support/allocation_counter.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::recording {
namespace {

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
