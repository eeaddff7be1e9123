#include "host_tools/lib/report/table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "host_tools/lib/report/markup.hpp"

namespace zerorate::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(NumberInATable, HasTheDecimalsAskedFor) {
  EXPECT_EQ(format_number(0.42, 3), "0.420");
  EXPECT_EQ(format_number(12, 0), "12");
  EXPECT_EQ(format_number(2.675, 1), "2.7");
}

TEST(NumberInATable, HasATrueMinusUnlessItRoundsToZero) {
  EXPECT_EQ(format_number(-1.5, 1), "\u22121.5");
  EXPECT_EQ(format_number(-0.0004, 2), "0.00");
}

TEST(NumberInATable, IsGroupedFromFiveDigitsOn) {
  EXPECT_EQ(format_number(9999, 0), "9999");
  EXPECT_EQ(format_number(12345, 0), "12\u202f345");
  EXPECT_EQ(format_number(-1234567.25, 2), "\u22121\u202f234\u202f567.25");
}

TEST(NumberInATable, IsADashWhereThereIsNone) {
  EXPECT_EQ(format_number(std::numeric_limits<double>::quiet_NaN(), 2), "\u2013");
  EXPECT_EQ(format_number(std::numeric_limits<double>::infinity(), 2), "\u2013");
}

TEST(Table, AlignsColumnsWithNumbersToTheRight) {
  const std::string html = render(Table{
      .caption = "Drives & more",
      .columns = {{.heading = "Predictor"}, {.heading = "Drift", .unit = "deg", .decimals = 2}},
      .rows = {{"kalman", 0.5}, {"<none>", "n/a"}}});
  EXPECT_THAT(html, HasSubstr("<caption><span>Drives &amp; more</span></caption>"));
  EXPECT_THAT(html, HasSubstr("<th scope=\"col\">Predictor</th>"));
  EXPECT_THAT(html, HasSubstr("<th scope=\"col\" class=\"number\">Drift"));
  EXPECT_THAT(html, HasSubstr("<td>kalman</td><td class=\"number\">0.50</td>"));
  EXPECT_THAT(html, HasSubstr("<td>&lt;none&gt;</td><td class=\"number\">n/a</td>"));
}

TEST(TableWithoutCaption, HasNoCaptionElement) {
  EXPECT_THAT(render(Table{.columns = {{.heading = "a"}}, .rows = {{1}}}),
              Not(HasSubstr("<caption")));
}

TEST(TableWithARowTooShort, IsRefusedByName) {
  const Table table{
      .caption = "Results", .columns = {{.heading = "a"}, {.heading = "b"}}, .rows = {{1, 2}, {3}}};
  try {
    (void)render(table);
    FAIL() << "the table was accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "table \"Results\": a row of 1 cells under 2 columns");
  }
}

}  // namespace
}  // namespace zerorate::report
