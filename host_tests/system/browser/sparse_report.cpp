/// Writes a report of charts that have little or nothing to show: what a short or failed run gives.
///
///     report_sparse OUT.html

#include <cstdio>
#include <exception>
#include <limits>

#include "host_tools/lib/report/report.hpp"

namespace zerorate::report {
namespace {

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

Chart chart_of(const char* title, Series series, Scale scale = Scale::linear) {
  return {.title = title,
          .x = {.label = "Time", .unit = "s", .scale = scale},
          .y = {.label = "Rate", .unit = "deg/h", .scale = scale},
          .series = {std::move(series)}};
}

Report sparse_report() {
  Report report("Charts with little to show", "None of them may fail.");
  report.section("Curves")
      .chart(Chart{.title = "No series."})
      .chart(chart_of("No points.", {.name = "none"}))
      .chart(
          chart_of("Nothing but gaps.", {.name = "gaps", .x = {0, 1, 2}, .y = {kGap, kGap, kGap}}))
      .chart(chart_of("One point.", {.name = "one", .x = {5}, .y = {3}}))
      .chart(chart_of("Constant.", {.name = "constant", .x = {0, 1}, .y = {-2, -2}}))
      .chart(chart_of("All at one x.", {.name = "same", .x = {1, 1, 1}, .y = {1, 3, 2}}))
      .chart(chart_of("A lone point between gaps.",
                      {.name = "lone", .x = {0, 1, 2, 3}, .y = {1, kGap, 2, kGap}}))
      .chart(chart_of("Microscopic.", {.name = "tiny", .x = {0, 1e-7}, .y = {1e-9, 2e-9}}));
  report.section("Curves on logarithmic axes")
      .chart(chart_of("Nothing positive.", {.name = "none", .x = {-1, 0}, .y = {1, 1}},
                      Scale::logarithmic))
      .chart(chart_of("One point.", {.name = "one", .x = {3}, .y = {3}}, Scale::logarithmic))
      .chart(chart_of("Within a decade.", {.name = "short", .x = {3.1, 3.9}, .y = {6.2, 6.8}},
                      Scale::logarithmic))
      .chart(chart_of("Twenty decades.", {.name = "long", .x = {1e-10, 1e10}, .y = {1e-12, 1e8}},
                      Scale::logarithmic));
  report.section("Bars")
      .chart(BarChart{.title = "No bars."})
      .chart(BarChart{.title = "No values.", .categories = {"a"}, .groups = {{"g", {kGap}}}})
      .chart(BarChart{
          .title = "Below zero.", .categories = {"a", "b"}, .groups = {{"g", {-1.5, 0.5}}}});
  return report;
}

}  // namespace
}  // namespace zerorate::report

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: report_sparse OUT.html\n", stderr);
    return 2;
  }
  try {
    zerorate::report::sparse_report().write(argv[1]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "report_sparse: %s\n", error.what());
    return 1;
  }
}
