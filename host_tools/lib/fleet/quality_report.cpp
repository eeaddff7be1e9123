// Yield, capability and control charts to look at.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "host_tools/lib/fleet/presentation.hpp"

namespace zerorate::fleet {
namespace {

double shown_of(std::size_t coordinate, double x) {
  const Shown& one = shown()[coordinate];
  return one.is_log ? one.per_si * std::exp(x) : x;
}

std::string text(const Index& index) {
  return fmt::format("{:.2f} [{:.2f}, {:.2f}]", index.value, index.lo, index.hi);
}

report::Table capability_table(const Quality& quality) {
  report::Table table{
      .caption =
          "Distance of the nearer limit from the mean over three spreads, with 95 % intervals: Ppk "
          "by the spread of all axes, Cpk by that within the lots. 1.33 and more is usually called "
          "capable. N and B are taken by their logarithms. Errors of the recordings are part of "
          "the spread: the sensors are no worse than this.",
      .columns = {
          {"Figure"}, {"Ppk"}, {"Cpk"}, {"Axes below the limit"}, {"Axes above the limit"}}};
  for (std::size_t i = 0; i < quality.figures.size(); ++i) {
    const auto& capability = quality.figures[i].capability;
    if (!capability) continue;
    table.rows.push_back({shown()[i].name, text(capability->ppk),
                          capability->cpk ? text(*capability->cpk) : std::string{"one lot"},
                          capability->below, capability->above});
  }
  return table;
}

/// Limits of an axis that there are, by their names, in the coordinate.
std::vector<std::pair<const char*, double>> finite_limits(const QualityFigure& figure) {
  std::vector<std::pair<const char*, double>> limits;
  if (!figure.limits) return limits;
  if (std::isfinite(figure.limits->lo)) limits.emplace_back("Lower limit", figure.limits->lo);
  if (std::isfinite(figure.limits->hi)) limits.emplace_back("Upper limit", figure.limits->hi);
  return limits;
}

std::string limits_text(const QualityFigure& figure, std::size_t coordinate) {
  std::string text;
  for (const auto& [name, level] : finite_limits(figure)) {
    text += fmt::format(" {} of an axis: {:.4g}{}{}.", name, shown_of(coordinate, level),
                        *shown()[coordinate].unit == 0 ? "" : " ", shown()[coordinate].unit);
  }
  return text;
}

report::Chart control_chart(const Population& population, const Quality& quality,
                            std::size_t coordinate) {
  const QualityFigure& figure = quality.figures[coordinate];
  const Shown& one = shown()[coordinate];
  report::Series sensors{.name = "Sensor, mean of its axes",
                         .style = report::SeriesStyle::points,
                         .colour = report::Colour::blue};
  const auto line = [&](const char* name, double level, report::Colour colour) {
    report::Series series{.name = name, .colour = colour, .dashed = true};
    series.x = {1.0, static_cast<double>(figure.values.size())};
    series.y.assign(2, shown_of(coordinate, level));
    return series;
  };
  for (std::size_t i = 0; i < figure.values.size(); ++i) {
    sensors.x.push_back(static_cast<double>(i + 1));
    sensors.y.push_back(shown_of(coordinate, figure.values[i]));
  }
  std::string outside;
  constexpr std::size_t kMostNames = 10;
  for (std::size_t k = 0; k < std::min(figure.chart.outside.size(), kMostNames); ++k) {
    outside += (k == 0 ? " Outside: " : ", ") +
               population.sensors[quality.order[figure.chart.outside[k]]].name;
  }
  if (figure.chart.outside.size() > kMostNames) outside += " and more";
  if (!outside.empty()) outside += ".";
  report::Chart chart{
      .title = fmt::format("{} in the order of lots and names", one.name),
      .caption = fmt::format(
          "Chart of individuals: lines are the mean and three sigma to either side, by the mean "
          "step from sensor to sensor. {} of {} sensors lie outside.{}{}",
          figure.chart.outside.size(), figure.values.size(), outside,
          limits_text(figure, coordinate)),
      .x = {"Sensor"},
      .y = {one.name, one.unit, one.is_log ? report::Scale::logarithmic : report::Scale::linear},
      .series = {std::move(sensors), line("Mean", figure.chart.centre, report::Colour::ink),
                 line("Lower control limit", figure.chart.lo, report::Colour::ink),
                 line("Upper control limit", figure.chart.hi, report::Colour::ink)}};
  for (const auto& [name, level] : finite_limits(figure)) {
    chart.series.push_back(line(name, level, report::Colour::vermilion));
  }
  return chart;
}

}  // namespace

std::string rate_text(double q) {
  constexpr double kLeast = 1e-6;
  return q < kLeast ? "below 1e-6" : fmt::format("{:.2g}", q);
}

std::string words(const Population& population, const Quality& quality) {
  if (!quality.has_limits) return {};
  std::string text = fmt::format(
      "Yield: {} of {} sensors pass the limits, {:.1f} % [{:.1f}, {:.1f}]; {} fail, {} were "
      "measured for too short a time to tell.",
      quality.passed, population.sensors.size(), 100.0 * quality.yield.value,
      100.0 * quality.yield.lo, 100.0 * quality.yield.hi, quality.failed, quality.too_short);
  for (std::size_t i = 0; i < quality.figures.size(); ++i) {
    const auto& capability = quality.figures[i].capability;
    if (!capability) continue;
    text += fmt::format(" {}: Ppk {:.2f} [{:.2f}, {:.2f}]", shown()[i].name, capability->ppk.value,
                        capability->ppk.lo, capability->ppk.hi);
    if (capability->cpk) {
      text += fmt::format(", Cpk {:.2f} [{:.2f}, {:.2f}]", capability->cpk->value,
                          capability->cpk->lo, capability->cpk->hi);
    }
    text += ".";
  }
  return text;
}

void shade_limits(const Quality& quality, std::size_t coordinate, report::Chart& chart) {
  const QualityFigure& figure = quality.figures[coordinate];
  if (finite_limits(figure).empty()) return;
  const std::vector<double>& x = chart.series.front().x;
  const double from = std::max(x.front(), shown_of(coordinate, figure.limits->lo));
  const double to = std::min(x.back(), shown_of(coordinate, figure.limits->hi));
  chart.caption += limits_text(figure, coordinate);
  if (from >= to) return;
  chart.shaded.push_back({from, to});
  chart.shaded_name = "Inside of the limits";
}

void add_quality(const Population& population, const Quality& quality, report::Report& report) {
  if (quality.has_limits) {
    report::Section& yield = report.section("Yield and capability");
    yield.key_figures(
        {{"Yield", fmt::format("{:.1f} %", 100.0 * quality.yield.value),
          fmt::format("95 %: {:.1f} to {:.1f} %", 100.0 * quality.yield.lo,
                      100.0 * quality.yield.hi)},
         {"Pass", fmt::format("{}", quality.passed), "sensors inside of all limits"},
         {"Fail", fmt::format("{}", quality.failed), "sensors outside of a limit"},
         {"Too short to tell", fmt::format("{}", quality.too_short), "a limit in the interval"}});
    const report::Table table = capability_table(quality);
    if (!table.rows.empty()) yield.table(table);
  }
  report::Section& charts = report.section("Control charts");
  for (std::size_t i = 0; i < quality.figures.size(); ++i) {
    if (quality.figures[i].values.size() > 1) charts.chart(control_chart(population, quality, i));
  }
}

}  // namespace zerorate::fleet
