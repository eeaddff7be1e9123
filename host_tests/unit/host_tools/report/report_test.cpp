#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "host_tests/support/folders.hpp"
#include "host_tools/lib/report/chart.hpp"
#include "host_tools/lib/report/markup.hpp"
#include "host_tools/lib/report/report.hpp"
#include "host_tools/lib/report/table.hpp"

namespace zerorate::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Report small_report() {
  Report report("Title", "Lead.");
  report.section("Result").paragraph("Text.").chart(
      Chart{.title = "Bias", .series = {{.name = "b", .x = {0, 1}, .y = {1, 2}}}});
  return report;
}

std::string text_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::size_t files_in(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

std::size_t count(const std::string& text, std::string_view part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++found;
  }
  return found;
}

TEST(Report, LoadsNothingFromElsewhere) {
  const std::string html = small_report().html();
  for (const char* load :
       {"<link", "<iframe", " src=", "@import", "url(", "fetch(", "XMLHttpRequest"}) {
    EXPECT_EQ(count(html, load), 0U) << load;
  }
  EXPECT_EQ(count(html, "href="), count(html, "href=\"#"));
  EXPECT_THAT(html, HasSubstr("Content-Security-Policy\" content=\"default-src 'none'"));
}

TEST(Report, CarriesTheChartLibraryWithItsLicence) {
  const std::string html = small_report().html();
  EXPECT_THAT(html, HasSubstr("var uPlot="));
  EXPECT_THAT(html, HasSubstr("Permission is hereby granted"));
  // The library, our own scripts and the data of one chart.
  EXPECT_EQ(count(html, "<script"), 3U);
  EXPECT_EQ(count(html, "</script>"), 3U);
}

TEST(Report, ShowsMarkupInTextsAsText) {
  Report report("<i>t</i>", "a & b");
  report.section("<h>")
      .paragraph("\"<p>\"")
      .listing("a < b\nc")
      .key_figures({{"<n>", "<v>", "it's"}});
  const std::string html = report.provenance("<end>").html();
  EXPECT_THAT(html, HasSubstr("<h1>&lt;i&gt;t&lt;/i&gt;</h1>"));
  EXPECT_THAT(html, HasSubstr("<title>&lt;i&gt;t&lt;/i&gt;</title>"));
  EXPECT_THAT(html, HasSubstr("a &amp; b"));
  EXPECT_THAT(html, HasSubstr("<h2>&lt;h&gt;</h2>"));
  EXPECT_THAT(html, HasSubstr("&quot;&lt;p&gt;&quot;"));
  EXPECT_THAT(html, HasSubstr("<code>a &lt; b\nc</code>"));
  EXPECT_THAT(html, HasSubstr("it&#39;s"));
  EXPECT_THAT(html, HasSubstr("&lt;end&gt;"));
}

TEST(ReportWithManySections, OpensWithTheirTable) {
  Report report("Title", "Lead.");
  for (int i = 1; i <= 4; ++i) report.section("Part " + std::to_string(i));
  EXPECT_THAT(report.html(), Not(HasSubstr("<nav")));
  report.section("Part 5");
  EXPECT_THAT(report.html(), HasSubstr("<li><a href=\"#section-5\">Part 5</a></li>"));
  EXPECT_THAT(report.html(), HasSubstr("<section id=\"section-5\">\n<h2>Part 5</h2>"));
}

TEST(ReportSection, StaysValidWhileOthersAreAdded) {
  Report report("Title", "Lead.");
  Section& first = report.section("First");
  for (int i = 0; i < 100; ++i) report.section("Further");
  first.paragraph("late");
  EXPECT_THAT(report.html(), HasSubstr("<h2>First</h2>\n<p>late</p>"));
}

TEST(WritingAReport, LeavesTheWholeFileAndNothingElse) {
  const testing::ScratchFolder folder;
  const auto path = folder.write("report.html", "an older report");
  small_report().write(path);
  EXPECT_EQ(text_of(path), small_report().html());
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(WritingAReportIntoAFolderThatIsNotThere, NamesPathAndReason) {
  const testing::ScratchFolder folder;
  const auto path = folder.path() / "missing" / "report.html";
  try {
    small_report().write(path);
    FAIL() << "the report was written";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), "cannot write " + path.string() + ": No such file or directory");
  }
}

TEST(WritingAReportOverAFolder, FailsAndLeavesNothingBehind) {
  const testing::ScratchFolder folder;
  const auto path = folder.path() / "taken";
  std::filesystem::create_directory(path);
  EXPECT_THROW(small_report().write(path), std::runtime_error);
  EXPECT_EQ(files_in(folder.path()), 1U);
}

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

using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

/// The data that the browser will find in the figure.
nlohmann::json data_of(const std::string& html) {
  const std::string opening = "<script type=\"application/json\">";
  const std::size_t begin = html.find(opening) + opening.size();
  return nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

Chart chart_of(Series series) {
  return {.title = "Bias",
          .x = {.label = "Time", .unit = "s"},
          .y = {.label = "Bias", .unit = "deg/h"},
          .series = {std::move(series)}};
}

std::string refusal_of(const auto& chart) {
  try {
    (void)render(chart);
    return "accepted";
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

TEST(Chart, HandsItsSeriesToTheBrowser) {
  const auto data = data_of(render(chart_of({.name = "kalman",
                                             .x = {0, 1, 2.5},
                                             .y = {-1, 1.0 / 3, 4e-9},
                                             .style = SeriesStyle::steps,
                                             .colour = Colour::green,
                                             .dashed = true})));
  const auto& series = data["series"][0];
  EXPECT_EQ(series["name"], "kalman");
  EXPECT_EQ(series["style"], "steps");
  EXPECT_EQ(series["ink"], "green");
  EXPECT_EQ(series["dashed"], true);
  EXPECT_EQ(series["x"], nlohmann::json({0.0, 1.0, 2.5}));
  EXPECT_EQ(series["y"], nlohmann::json({-1.0, 0.3333333, 4e-9}));
  EXPECT_EQ(data["y"]["unit"], "deg/h");
  EXPECT_FALSE(series.contains("lo"));
}

TEST(ChartWithAnOrigin, CountsXAndShadesFromIt) {
  const Chart chart{.title = "Bias",
                    .x = {.label = "Time", .unit = "s", .origin = 1.796e9},
                    .series = {{.name = "b", .x = {1.796e9, 1.796e9 + 2.125}, .y = {1, 2}}},
                    .shaded = {{1.796e9 + 0.5, 1.796e9 + 1.5}}};
  const auto data = data_of(render(chart));
  EXPECT_EQ(data["series"][0]["x"], nlohmann::json({0.0, 2.125}));
  EXPECT_EQ(data["shaded"][0], nlohmann::json({0.5, 1.5}));
}

TEST(OriginOfTimes, IsNamedOnce) {
  EXPECT_EQ(origin_in_words(0.01), "");
  EXPECT_THAT(origin_in_words(812.4), HasSubstr("at 812 s of the recording's clock"));
  EXPECT_THAT(origin_in_words(1.796e9), HasSubstr("at 2026-11-30 00:53:20 UTC"));
}

TEST(Chart, GivesColoursByPositionInTurn) {
  Chart chart = chart_of({.name = "0"});
  for (int i = 1; i < 7; ++i) chart.series.push_back({.name = std::to_string(i)});
  const auto data = data_of(render(chart));
  EXPECT_EQ(data["series"][0]["ink"], "blue");
  EXPECT_EQ(data["series"][1]["ink"], "vermilion");
  EXPECT_EQ(data["series"][6]["ink"], "blue");
}

TEST(Chart, IsDescribedToThoseWhoDoNotSeeIt) {
  EXPECT_THAT(render(chart_of({.name = "kalman \"2\""})),
              HasSubstr("role=\"img\" aria-label=\"Line chart: Bias. Bias, deg/h over Time, s. "
                        "Shown: kalman &quot;2&quot;.\""));
}

TEST(ChartWithValuesThatAreNotFinite, HasGapsThere) {
  const auto data = data_of(render(
      chart_of({.x = {0, 1, 2, 3}, .y = {1, kGap, std::numeric_limits<double>::infinity(), 2}})));
  EXPECT_EQ(data["series"][0]["y"], nlohmann::json({1.0, nullptr, nullptr, 2.0}));
}

TEST(ChartOnLogarithmicAxes, LeavesOutWhatHasNoLogarithm) {
  Chart chart = chart_of({.x = {-1, 0, 1, 10}, .y = {5, 5, 0, 2}});
  chart.x.scale = Scale::logarithmic;
  chart.y.scale = Scale::logarithmic;
  const auto data = data_of(render(chart));
  EXPECT_EQ(data["series"][0]["x"], nlohmann::json({1.0, 10.0}));
  EXPECT_EQ(data["series"][0]["y"], nlohmann::json({nullptr, 2.0}));
}

TEST(ChartOfAMillionPoints, IsASmallFile) {
  Series series{.name = "rate"};
  for (int i = 0; i < 1'000'000; ++i) {
    series.x.push_back(0.01 * i);
    series.y.push_back(std::sin(0.37 * i));
  }
  const std::string html = render(chart_of(series));
  EXPECT_LT(html.size(), 150'000U);
  EXPECT_EQ(data_of(html)["series"][0]["x"].back(), 9999.99);
}

TEST(ChartThatIsThinned, SaysHowManyOfItsPointsItHolds) {
  Series series{.name = "flat", .x = std::vector<double>(20'000), .y = {}};
  for (std::size_t i = 0; i < series.x.size(); ++i) series.x[i] = static_cast<double>(i);
  series.y.assign(series.x.size(), 1.0);
  // The first point of a flat column is also the least and the greatest: two per column are left.
  EXPECT_THAT(render(chart_of(series)), HasSubstr("2000 of 20\u202f000 points"));
  EXPECT_THAT(render(chart_of({.x = {1}, .y = {1}})), Not(HasSubstr("points:")));
}

TEST(ChartWithMarkupInItsTexts, KeepsItAsText) {
  const std::string evil = "</script><script>alert(1)</script><!--";
  Chart chart = chart_of({.name = evil});
  chart.title = evil;
  chart.shaded_name = evil;
  const std::string html = render(chart);
  EXPECT_EQ(data_of(html)["series"][0]["name"], evil);
  EXPECT_EQ(data_of(html)["shadedName"], evil);
  EXPECT_THAT(html, Not(HasSubstr("<script>")));
  EXPECT_THAT(html, Not(HasSubstr("<!--")));
  EXPECT_EQ(html.find("</script>"), html.rfind("</script>"));
}

TEST(ChartWithANameThatIsNotUtf8, IsStillWritten) {
  EXPECT_EQ(data_of(render(chart_of({.name = "bad\xff"})))["series"][0]["name"], "bad\ufffd");
}

TEST(ChartWithInconsistentSeries, IsRefusedByName) {
  EXPECT_EQ(refusal_of(chart_of({.name = "a", .x = {1, 2}, .y = {1}})),
            "chart \"Bias\", series \"a\": x and y differ in length");
  EXPECT_EQ(refusal_of(chart_of({.name = "a", .x = {2, 1}, .y = {1, 1}})),
            "chart \"Bias\", series \"a\": x decreases");
  EXPECT_EQ(refusal_of(chart_of({.name = "a", .x = {kGap}, .y = {1}})),
            "chart \"Bias\", series \"a\": x is not finite");
  EXPECT_EQ(refusal_of(chart_of({.name = "a", .x = {1}, .y = {1}, .lo = {1}})),
            "chart \"Bias\", series \"a\": the band is not as long as y");
}

TEST(BarChart, HandsItsGroupsToTheBrowser) {
  const std::string html = render(BarChart{
      .title = "Drift",
      .y = {.label = "Ratio"},
      .categories = {"15/60", "30/120"},
      .groups = {{.name = "kalman", .values = {0.65, kGap}, .lo = {0.6, kGap}, .hi = {0.7, kGap}}},
      .reference = Reference{"calibration mean", 1}});
  const auto data = data_of(html);
  EXPECT_EQ(data["groups"][0]["values"], nlohmann::json({0.65, nullptr}));
  EXPECT_EQ(data["groups"][0]["hi"], nlohmann::json({0.7, nullptr}));
  EXPECT_EQ(data["reference"]["value"], 1.0);
  EXPECT_THAT(html, HasSubstr("data-chart=\"bars\""));
}

TEST(BarChartWithInconsistentGroups, IsRefusedByName) {
  BarChart chart{
      .title = "Drift", .categories = {"a", "b"}, .groups = {{.name = "k", .values = {1}}}};
  EXPECT_EQ(refusal_of(chart), "chart \"Drift\", group \"k\": not one value a category");
  chart.groups[0].values = {1, 2};
  chart.groups[0].hi = {2, 3};
  EXPECT_EQ(refusal_of(chart),
            "chart \"Drift\", group \"k\": the error bars are not as many as the values");
  chart.groups[0].hi.clear();
  chart.y.scale = Scale::logarithmic;
  EXPECT_EQ(refusal_of(chart), "chart \"Drift\": bars have no logarithmic axis");
}

}  // namespace
}  // namespace zerorate::report
