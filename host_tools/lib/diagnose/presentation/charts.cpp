#include "host_tools/lib/diagnose/presentation/presentation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using report::Colour;

using units::kDegPerRad;
using units::kDphPerRadS;

/// Curve and bands of a statistic, each value through the same scaling.
template <class Scaling>
std::vector<report::Series> envelope(const Diagnosis& diagnosis,
                                     const std::vector<CurvePoint>& points, Scaling scaled) {
  report::Series measured{.name = "recording", .colour = Colour::ink, .marks = true};
  report::Series base{.name = diagnosis.is_base_given ? "given model, 95 % of simulations"
                                                      : "white + 1/f, 95 % of simulations",
                      .colour = Colour::grey,
                      .dashed = true};
  report::Series extended{.name = "extended model, 95 %", .colour = Colour::blue};
  for (const CurvePoint& point : points) {
    for (report::Series* series : {&measured, &base, &extended}) series->x.push_back(point.x);
    measured.y.push_back(scaled(point.measured));
    base.y.push_back(scaled(point.base));
    base.lo.push_back(scaled(point.base_lo));
    base.hi.push_back(scaled(point.base_hi));
    extended.y.push_back(scaled(point.extended));
    extended.lo.push_back(scaled(point.extended_lo));
    extended.hi.push_back(scaled(point.extended_hi));
  }
  std::vector<report::Series> all{std::move(base)};
  if (!diagnosis.causes.empty()) all.push_back(std::move(extended));
  all.push_back(std::move(measured));
  return all;
}

std::string envelope_caption(const Diagnosis& diagnosis) {
  std::string text = "Where the recording leaves the grey band the simulation is wrong.";
  if (!diagnosis.causes.empty()) text += " The extended model should hold it in the blue one.";
  return text;
}

/// A recording of one axis needs no name of the axis.
std::string of_axis(const Diagnosis& diagnosis) {
  return diagnosis.axis == "rate" ? "." : " of axis " + diagnosis.axis + ".";
}

/// In deg/s.
report::Series rate_series(std::string name, const std::vector<Point>& points, Colour colour,
                           report::SeriesStyle style) {
  report::Series series{.name = std::move(name), .style = style, .colour = colour};
  for (const Point& point : points) {
    series.x.push_back(point.time_s);
    series.y.push_back(point.rate_rad_s * kDegPerRad);
  }
  return series;
}

/// Longest bar: a longer one would only flatten the others.
constexpr double kTallestBarNats = 100.0;

report::Reference even() {
  return {.name = "as before", .value = 1.0};
}

}  // namespace

report::Chart allan_chart(const Diagnosis& diagnosis) {
  return {.title = "Allan deviation" + of_axis(diagnosis),
          .caption = envelope_caption(diagnosis),
          .x = {"Averaging time", "s", report::Scale::logarithmic},
          .y = {"Allan deviation", "deg/h", report::Scale::logarithmic},
          .series = envelope(diagnosis, diagnosis.allan,
                             [](double rad_s) { return rad_s * kDphPerRadS; })};
}

report::Chart density_chart(const Diagnosis& diagnosis) {
  return {.title = "Noise density" + of_axis(diagnosis),
          .caption = "One-sided, as data sheets state it. " + envelope_caption(diagnosis),
          .x = {"Frequency", "Hz", report::Scale::logarithmic},
          .y = {"Rate noise density", "deg/s/sqrt(Hz)", report::Scale::logarithmic},
          .series = envelope(diagnosis, diagnosis.density,
                             [](double density) { return std::sqrt(density) * kDegPerRad; })};
}

report::Chart effect_chart(const Diagnosis& diagnosis, const Drawing& drawing) {
  const std::string effect = plain_name(drawing.effect);
  report::Chart chart{.title = "The recording and its " + effect + ".",
                      .caption = drawing.curve.empty()
                                     ? "Marked are the samples that the effect has touched."
                                     : "The curve is the effect with the constant bias.",
                      .x = {"Time", "s"},
                      .y = {"Rate", "deg/s"}};
  chart.series.push_back(
      rate_series("recording", diagnosis.thinned, Colour::grey,
                  drawing.curve.empty() ? report::SeriesStyle::points : report::SeriesStyle::line));
  if (!drawing.curve.empty()) {
    chart.series.push_back(
        rate_series(effect, drawing.curve, Colour::vermilion, report::SeriesStyle::line));
  }
  if (!drawing.marks.empty()) {
    chart.series.push_back(rate_series("touched samples", drawing.marks, Colour::vermilion,
                                       report::SeriesStyle::points));
  }
  return chart;
}

report::BarChart evidence_chart(const Diagnosis& diagnosis) {
  report::BarChart chart{
      .title = "Evidence of each effect when it alone is added.",
      .caption =
          "Log likelihood gained. An effect is credible when its gain exceeds its price: "
          "what its parameters, and the search for them, gain by chance.",
      .y = {"Gain", "nats"}};
  report::BarGroup gain{.name = "gain", .colour = Colour::blue};
  report::BarGroup price{.name = "price", .colour = Colour::grey};
  bool cut = false;
  for (const SelectionEvidence& evidence : diagnosis.evidence) {
    if (!evidence.not_examined.empty()) continue;
    cut |= evidence.gain_nats > kTallestBarNats;
    chart.categories.push_back(plain_name(evidence.effect));
    gain.values.push_back(std::clamp(evidence.gain_nats, 0.0, kTallestBarNats));
    price.values.push_back(evidence.price_nats);
  }
  if (cut) chart.caption += fmt::format(" Bars are cut at {:.0f} nats.", kTallestBarNats);
  chart.groups = {std::move(gain), std::move(price)};
  return chart;
}

report::BarChart error_chart(const Gain& gain) {
  report::BarChart chart{.title = "Error of prediction, extended over base.",
                         .caption = fmt::format("On the {} samples that were held out; below one "
                                                "the extended model is better. 95 % intervals.",
                                                gain.holdout_samples),
                         .y = {"Ratio of errors"}};
  report::BarGroup ratios{.name = "extended / base", .colour = Colour::blue};
  const auto add = [&](const char* what, const BootstrapFigure& ratio) {
    if (!std::isfinite(ratio.value)) return;
    chart.categories.emplace_back(what);
    ratios.values.push_back(ratio.value);
    ratios.lo.push_back(ratio.lo);
    ratios.hi.push_back(ratio.hi);
  };
  add("rate (RSSE)", gain.rsse_ratio);
  add("angle (IE)", gain.ie_ratio);
  add("heading drift", gain.heading_drift_ratio);
  chart.groups = {std::move(ratios)};
  chart.reference = even();
  return chart;
}

report::BarChart coverage_chart(const Gain& gain) {
  const auto group = [](const char* name, const BootstrapFigure& coverage, Colour colour) {
    return report::BarGroup{.name = name,
                            .values = {100.0 * coverage.value},
                            .colour = colour,
                            .lo = {100.0 * coverage.lo},
                            .hi = {100.0 * coverage.hi}};
  };
  return {.title = "How often the 95 % interval holds.",
          .caption = "Headings inside the interval that the node itself gives.",
          .y = {"Coverage", "%"},
          .categories = {fmt::format("drives of {} s", units::in_figures(gain.drive_s))},
          .groups = {group("before", gain.coverage95_base, Colour::grey),
                     group("after", gain.coverage95_extended, Colour::blue)},
          .reference = report::Reference{.name = "nominal", .value = 95.0}};
}

}  // namespace zerorate::diagnose
