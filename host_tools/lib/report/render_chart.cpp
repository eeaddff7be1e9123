#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>

#include "host_tools/lib/report/markup.hpp"
#include "host_tools/lib/report/thin.hpp"

namespace zerorate::report {
namespace {

using nlohmann::json;

/// Names of the CSS custom properties that hold the inks, in the order of Colour.
constexpr std::string_view kInkNames[] = {"blue",  "vermilion", "green", "purple",
                                          "amber", "grey",      "ink"};

std::string ink_name(Colour colour, std::size_t position) {
  // Ink is for truth and references: taken by name only.
  constexpr std::size_t kInTurn = std::size(kInkNames) - 1;
  if (colour == Colour::by_position) return std::string(kInkNames[position % kInTurn]);
  return std::string(kInkNames[static_cast<std::size_t>(colour) - 1]);
}

/// The figures are for the eye: digits beyond these would only make the file larger. Time has more,
/// to keep milliseconds of a month apart.
constexpr int kDigitsOfX = 10;
constexpr int kDigitsOfY = 7;

json rounded(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  return std::strtod(fmt::format("{:.{}g}", value, digits).c_str(), nullptr);
}

json rounded(std::span<const double> values, std::span<const std::size_t> indices, int digits) {
  json list = json::array();
  for (const std::size_t i : indices) list.push_back(rounded(values[i], digits));
  return list;
}

json rounded(std::span<const double> values, int digits) {
  json list = json::array();
  for (const double value : values) list.push_back(rounded(value, digits));
  return list;
}

json axis_json(const Axis& axis) {
  return {{"label", axis.label},
          {"unit", axis.unit},
          {"logarithmic", axis.scale == Scale::logarithmic}};
}

std::string_view style_name(SeriesStyle style) {
  switch (style) {
    case SeriesStyle::line:
      return "line";
    case SeriesStyle::steps:
      return "steps";
    case SeriesStyle::points:
      return "points";
  }
  return "line";
}

void check(const Chart& chart, const Series& series) {
  const auto refuse = [&](std::string_view reason) {
    throw std::invalid_argument(
        fmt::format("chart \"{}\", series \"{}\": {}", chart.title, series.name, reason));
  };
  if (series.x.size() != series.y.size()) refuse("x and y differ in length");
  const bool has_band = !series.lo.empty() || !series.hi.empty();
  if (has_band && (series.lo.size() != series.y.size() || series.hi.size() != series.y.size())) {
    refuse("the band is not as long as y");
  }
  if (!std::all_of(series.x.begin(), series.x.end(), [](double x) { return std::isfinite(x); })) {
    refuse("x is not finite");
  }
  if (!std::is_sorted(series.x.begin(), series.x.end())) refuse("x decreases");
}

/// First index of x that the axis can show; x ascends.
std::size_t first_shown(const Series& series, Scale scale) {
  if (scale == Scale::linear) return 0;
  const auto positive = std::upper_bound(series.x.begin(), series.x.end(), 0.0);
  return static_cast<std::size_t>(positive - series.x.begin());
}

DisplayWindow window_of(const Chart& chart) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  DisplayWindow window{.from = kInfinity, .to = -kInfinity, .scale = chart.x.scale};
  for (const Series& series : chart.series) {
    const std::size_t first = first_shown(series, chart.x.scale);
    if (first == series.x.size()) continue;
    window.from = std::min(window.from, series.x[first]);
    window.to = std::max(window.to, series.x.back());
  }
  return window;
}

/// The values from `first` on, with gaps where the axis cannot show them.
std::vector<double> shown(const std::vector<double>& values, std::size_t first, Scale scale) {
  if (values.empty()) return {};
  std::vector<double> result(values.begin() + static_cast<std::ptrdiff_t>(first), values.end());
  if (scale == Scale::logarithmic) {
    std::replace_if(
        result.begin(), result.end(), [](double v) { return !(v > 0); },
        std::numeric_limits<double>::quiet_NaN());
  }
  return result;
}

json series_json(const Series& series, const Chart& chart, std::size_t position,
                 const DisplayWindow& window) {
  const std::size_t first = first_shown(series, chart.x.scale);
  const auto x = std::span(series.x).subspan(first);
  const auto y = shown(series.y, first, chart.y.scale);
  const auto lo = shown(series.lo, first, chart.y.scale);
  const auto hi = shown(series.hi, first, chart.y.scale);
  const std::vector<std::span<const double>> channels =
      lo.empty() ? std::vector<std::span<const double>>{y}
                 : std::vector<std::span<const double>>{y, lo, hi};
  const auto kept = thin_for_display(x, channels, window);

  json result = {{"name", series.name},
                 {"style", style_name(series.style)},
                 {"ink", ink_name(series.colour, position)},
                 {"dashed", series.dashed},
                 {"marks", series.marks},
                 {"x", rounded(x, kept, kDigitsOfX)},
                 {"y", rounded(y, kept, kDigitsOfY)}};
  if (!lo.empty()) {
    result["lo"] = rounded(lo, kept, kDigitsOfY);
    result["hi"] = rounded(hi, kept, kDigitsOfY);
  }
  return result;
}

void check(const BarChart& chart) {
  for (const BarGroup& group : chart.groups) {
    const auto refuse = [&](std::string_view reason) {
      throw std::invalid_argument(
          fmt::format("chart \"{}\", group \"{}\": {}", chart.title, group.name, reason));
    };
    if (group.values.size() != chart.categories.size()) refuse("not one value a category");
    const bool has_errors = !group.lo.empty() || !group.hi.empty();
    if (has_errors &&
        (group.lo.size() != group.values.size() || group.hi.size() != group.values.size())) {
      refuse("the error bars are not as many as the values");
    }
  }
  if (chart.y.scale != Scale::linear) {
    throw std::invalid_argument(
        fmt::format("chart \"{}\": bars have no logarithmic axis", chart.title));
  }
}

/// "Bias, deg/h"
std::string axis_title(const Axis& axis) {
  return axis.unit.empty() ? axis.label : fmt::format("{}, {}", axis.label, axis.unit);
}

/// Description of the chart for somebody who does not see it.
template <class Items>
std::string spoken(std::string_view kind, const std::string& title, const Axis& y,
                   std::string_view over, const Items& items) {
  std::string names;
  for (const auto& item : items) names += (names.empty() ? "" : "; ") + item.name;
  return fmt::format("{}: {}. {} over {}. Shown: {}.", kind, title, axis_title(y), over, names);
}

/// Says so where a chart does not hold all its points, since zooming in would show it otherwise.
std::string thinning_note(const Chart& chart, const json& series) {
  std::size_t all = 0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    all += chart.series[i].x.size() - first_shown(chart.series[i], chart.x.scale);
    kept += series[i]["x"].size();
  }
  if (kept == all) return "";
  return fmt::format(
      " ({} of {} points: the first, last, least and greatest of every pixel column)",
      format_number(static_cast<double>(kept), 0), format_number(static_cast<double>(all), 0));
}

/// The texts around a chart.
struct Figure {
  std::string_view kind;
  std::string title;
  std::string caption;
  std::string spoken;
  std::string note;
};

/// The frame that web/*.js fills: legend and plot are drawn, the table is made when it is opened.
std::string figure_html(const Figure& figure, const json& data) {
  return fmt::format(
      "<figure class=\"chart\" data-chart=\"{}\">\n"
      "<figcaption><strong>{}</strong> {}</figcaption>\n"
      "<div class=\"legend\"></div>\n"
      "<div class=\"plot\" role=\"img\" aria-label=\"{}\"></div>\n"
      "<details><summary>Figures as a table{}</summary>"
      "<div class=\"table\" tabindex=\"0\"></div></details>\n"
      "<script type=\"application/json\">{}</script>\n"
      "</figure>\n",
      figure.kind, escape_html(figure.title), escape_html(figure.caption),
      escape_html(figure.spoken), figure.note, script_json(data));
}

}  // namespace

namespace {

/// Curves with x counted from the origin of its axis.
Chart counted_from_origin(Chart chart) {
  for (Series& one : chart.series) {
    for (double& x : one.x) x -= chart.x.origin;
  }
  for (Interval& interval : chart.shaded) {
    interval.from -= chart.x.origin;
    interval.to -= chart.x.origin;
  }
  chart.x.origin = 0.0;
  return chart;
}

}  // namespace

std::string render(const Chart& chart) {
  if (chart.x.origin != 0.0) return render(counted_from_origin(chart));
  json series = json::array();
  for (const Series& one : chart.series) check(chart, one);
  const DisplayWindow window = window_of(chart);
  for (const Series& one : chart.series) {
    series.push_back(series_json(one, chart, series.size(), window));
  }
  json shaded = json::array();
  for (const Interval& interval : chart.shaded) {
    shaded.push_back({rounded(interval.from, kDigitsOfX), rounded(interval.to, kDigitsOfX)});
  }
  return figure_html(
      {.kind = "curves",
       .title = chart.title,
       .caption = chart.caption,
       .spoken = spoken("Line chart", chart.title, chart.y, axis_title(chart.x), chart.series),
       .note = thinning_note(chart, series)},
      {{"x", axis_json(chart.x)},
       {"y", axis_json(chart.y)},
       {"series", series},
       {"shaded", shaded},
       {"shadedName", chart.shaded_name}});
}

std::string render(const BarChart& chart) {
  check(chart);
  json groups = json::array();
  for (const BarGroup& group : chart.groups) {
    groups.push_back({{"name", group.name},
                      {"ink", ink_name(group.colour, groups.size())},
                      {"values", rounded(group.values, kDigitsOfY)},
                      {"lo", rounded(group.lo, kDigitsOfY)},
                      {"hi", rounded(group.hi, kDigitsOfY)}});
  }
  json data = {{"y", axis_json(chart.y)}, {"categories", chart.categories}, {"groups", groups}};
  if (chart.reference) {
    data["reference"] = {{"name", chart.reference->name},
                         {"value", rounded(chart.reference->value, kDigitsOfY)}};
  }
  return figure_html(
      {.kind = "bars",
       .title = chart.title,
       .caption = chart.caption,
       .spoken = spoken("Bar chart", chart.title, chart.y, "categories", chart.groups),
       .note = ""},
      data);
}

}  // namespace zerorate::report
