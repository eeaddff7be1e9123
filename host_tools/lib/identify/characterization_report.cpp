#include "host_tools/lib/identify/characterization_report.hpp"

#include <fmt/format.h>
#include <cmath>
#include <numbers>

#include "firmware/model/model_file.hpp"
#include "host_tools/lib/identify/density.hpp"
#include "host_tools/lib/spectrum/noise_strength.hpp"
#include "host_tools/lib/statistics/half_width.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::identify {
namespace {

using report::Chart;
using report::Colour;
using report::Scale;

using units::in_figures;
using units::kDegPerRad;
using units::kDegRtHPerRadRtS;
using units::kDphPerRadS;
using units::kDphRtHPerRadSRtS;

/// Allan deviation of one kind of noise, a straight line of the plot.
struct Slope {
  std::string name;
  double at_1s;     ///< deviation at an averaging time of 1 s [rad/s]
  double exponent;  ///< power of the averaging time

  [[nodiscard]] double at(double tau_s) const { return at_1s * std::pow(tau_s, exponent); }
};

std::vector<Slope> slopes_of(const NoiseCoefficients& coefficients) {
  const auto figure = [](const IntervalEstimate& estimate, double unit) {
    return in_figures(estimate.value * unit);
  };
  const auto& n = coefficients.angle_random_walk_rad_per_sqrt_s;
  std::vector<Slope> slopes{
      {fmt::format("N = {} deg/√h, slope -1/2", figure(n, kDegRtHPerRadRtS)), n.value, -0.5}};
  if (const auto& b = coefficients.bias_instability_rad_s) {
    slopes.push_back({fmt::format("B = {} deg/h, floor 0.664 B", figure(*b, kDphPerRadS)),
                      spectrum::allan_floor(b->value), 0.0});
  }
  if (const auto& k = coefficients.rate_random_walk_rad_s_per_sqrt_s) {
    slopes.push_back({fmt::format("K = {} deg/h/√h, slope +1/2", figure(*k, kDphRtHPerRadSRtS)),
                      k->value / std::numbers::sqrt3, 0.5});
  }
  return slopes;
}

/// The lines of N, B and K, each where it is a good part of the whole.
void add_slopes(const AxisCharacterization& axis, std::vector<report::Series>& series) {
  constexpr double kGoodPart = 0.4;
  const std::vector<Slope> slopes = slopes_of(axis.coefficients);
  for (const Slope& slope : slopes) {
    report::Series line{.name = slope.name, .dashed = true};
    for (const AllanPoint& point : axis.allan) {
      double all = 0.0;
      for (const Slope& one : slopes) all = std::hypot(all, one.at(point.tau_s));
      if (slope.at(point.tau_s) < kGoodPart * all) continue;
      line.x.push_back(point.tau_s);
      line.y.push_back(slope.at(point.tau_s) * kDphPerRadS);
    }
    if (line.x.size() > 1) series.push_back(std::move(line));
  }
}

Chart allan_chart(const AxisCharacterization& axis) {
  report::Series measured{.name = "recording, 95 % interval", .colour = Colour::blue};
  report::Series fitted{.name = "fitted model", .colour = Colour::ink, .dashed = true};
  for (const AllanPoint& point : axis.allan) {
    measured.x.push_back(point.tau_s);
    measured.y.push_back(point.adev * kDphPerRadS);
    measured.lo.push_back(point.lo * kDphPerRadS);
    measured.hi.push_back(point.hi * kDphPerRadS);
    fitted.x.push_back(point.tau_s);
    fitted.y.push_back(model_allan_deviation(axis.model, point.tau_s) * kDphPerRadS);
  }
  Chart chart{
      .title = "Allan deviation of axis " + axis.axis,
      .caption =
          "The line that falls is white noise (N is its level at 1 s; with much flicker noise the "
          "deviation is larger), the flat one flicker noise (B), the one that rises a random walk "
          "(K is its level at 3 s). Where the model leaves the band the recording holds something "
          "else.",
      .x = {"Averaging time", "s", Scale::logarithmic},
      .y = {"Allan deviation", "deg/h", Scale::logarithmic},
      .series = {std::move(measured), std::move(fitted)}};
  add_slopes(axis, chart.series);
  return chart;
}

Chart density_chart(const AxisCharacterization& axis) {
  report::Series measured{.name = "recording, 95 % interval", .colour = Colour::blue};
  report::Series fitted{.name = "fitted model", .colour = Colour::ink, .dashed = true};
  for (const DensityBin& bin : axis.density) {
    const double root = std::sqrt(bin.density) * kDegPerRad;
    // A mean of p periodogram points is chi squared with 2p degrees of freedom; on the logarithm
    // of its root the standard error is 1 / (2 sqrt(p)).
    const double spread =
        std::exp(0.5 * statistics::kHalfWidth95 / std::sqrt(static_cast<double>(bin.points)));
    measured.x.push_back(bin.frequency_hz);
    measured.y.push_back(root);
    measured.lo.push_back(root / spread);
    measured.hi.push_back(root * spread);
    fitted.x.push_back(bin.frequency_hz);
    fitted.y.push_back(std::sqrt(2.0 * model_density(axis.model, bin.frequency_hz)) * kDegPerRad);
  }
  return {.title = "Noise density of axis " + axis.axis,
          .caption =
              "One-sided, as data sheets state it: sqrt(2) times the two-sided angle random walk. "
              "The model is fitted to means over filter ticks; lines, the sensor's low-pass and "
              "quantization at higher frequencies are not part of this model.",
          .x = {"Frequency", "Hz", Scale::logarithmic},
          .y = {"Rate noise density", "deg/s/sqrt(Hz)", Scale::logarithmic},
          .series = {std::move(measured), std::move(fitted)}};
}

std::string order_text(const FittedFlicker& flicker) {
  return fmt::format("{} ({})", text(flicker.order), explain(flicker.order_source));
}

std::vector<report::KeyFigure> key_figures(const AxisCharacterization& axis) {
  const auto& arw = axis.fit.angle_random_walk_rad_per_sqrt_s;
  std::vector<report::KeyFigure> figures{
      {"Angle random walk", fmt::format("{:.3g} deg/√h", arw.value * kDegRtHPerRadRtS),
       "95 %: " + text(arw, kDegRtHPerRadRtS)}};
  if (axis.fit.flicker) {
    const auto& b = axis.fit.flicker->bias_instability_rad_s;
    figures.push_back({"Flicker noise at 1 rad/s",
                       fmt::format("{:.3g} deg/h", b.value * kDphPerRadS),
                       "95 %: " + text(b, kDphPerRadS)});
    figures.push_back({"Order d", fmt::format("{:.2f}", axis.fit.flicker->order.value),
                       order_text(*axis.fit.flicker)});
  } else {
    figures.push_back({"Flicker noise", "not detectable",
                       fmt::format("p = {:.2g} for flicker noise", axis.fit.p_value)});
  }
  if (!axis.allan.empty()) {
    const AllanPoint& floor = axis.allan_floor();
    figures.push_back(
        {"Allan floor", in_figures(floor.adev * kDphPerRadS) + " deg/h", floor_text(axis)});
  }
  return figures;
}

report::Table coefficient_table(const Characterization& result) {
  report::Table table{
      .caption =
          "Coefficients of IEEE Std 952 with 95 % intervals: white noise, 1/f noise and a "
          "random walk of the rate, fitted together. Their B is that of 1/f noise, d = 1/2.",
      .columns = {{"Axis"},
                  {"Angle random walk N", "deg/√h"},
                  {"Bias instability B", "deg/h"},
                  {"Rate random walk K", "deg/h/√h"},
                  {"Floor of the Allan deviation", "deg/h"}}};
  for (const auto& axis : result.axes) {
    const NoiseCoefficients& one = axis.coefficients;
    table.rows.push_back({axis.axis, text(one.angle_random_walk_rad_per_sqrt_s, kDegRtHPerRadRtS),
                          text(one.bias_instability_rad_s, kDphPerRadS),
                          text(one.rate_random_walk_rad_s_per_sqrt_s, kDphRtHPerRadSRtS),
                          floor_text(axis)});
  }
  return table;
}

/// N and K of the files for programs that have no flicker noise.
report::Table filter_table(const Characterization& result) {
  report::Table table{
      .caption =
          "White noise and a random walk alone, for filters that have no 1/f noise "
          "(--kalibr, --gtsam, --matlab, --robot-localization). K stands for all of the slow "
          "noise and is larger than in the table above.",
      .columns = {{"Axis"}, {"N", "deg/√h"}, {"K", "deg/h/√h"}}};
  for (const auto& axis : result.axes) {
    const auto& pair = axis.coefficients.without_flicker;
    if (!pair) continue;
    table.rows.push_back({axis.axis, text(pair->angle_random_walk_rad_per_sqrt_s, kDegRtHPerRadRtS),
                          text(pair->rate_random_walk_rad_s_per_sqrt_s, kDphRtHPerRadSRtS)});
  }
  return table;
}

report::Table model_table(const Characterization& result) {
  report::Table table{
      .caption =
          "Model for the node, with 95 % intervals. Two-sided densities: white noise N^2, "
          "flicker noise F^2 (2 pi f)^(-2d), whose order d takes the place of K. Its strength F "
          "at 1 rad/s is B where d = 1/2 alone.",
      .columns = {
          {"Axis"}, {"N", "deg/s/sqrt(Hz)"}, {"Flicker noise F at 1 rad/s", "deg/h"}, {"Order d"}}};
  for (const auto& axis : result.axes) {
    const auto& flicker = axis.fit.flicker;
    table.rows.push_back(
        {axis.axis, text(axis.fit.angle_random_walk_rad_per_sqrt_s, kDegPerRad),
         flicker ? text(flicker->bias_instability_rad_s, kDphPerRadS) : "not detectable",
         flicker ? order_text(*flicker) : ""});
  }
  return table;
}

report::Table sameness_table(const Characterization& result) {
  report::Table table{
      .caption = fmt::format("Does one parameter set serve all recordings? A likelihood ratio test "
                             "that errs in {:.0f} "
                             "% of the sensors that have not changed, all axes together.",
                             100.0 * Sameness::kSize),
      .columns = {{"Axis"},
                  {"Recording"},
                  {"N", "deg/s/sqrt(Hz)"},
                  {"Flicker noise F at 1 rad/s", "deg/h"},
                  {"p"}}};
  for (const Sameness& axis : result.sameness) {
    const auto row = [&](const std::string& name, const InnovationsFit& fit,
                         const std::string& verdict) {
      table.rows.push_back(
          {axis.axis, name, text(fit.angle_random_walk_rad_per_sqrt_s, kDegPerRad),
           fit.flicker ? text(fit.flicker->bias_instability_rad_s, kDphPerRadS) : "none", verdict});
    };
    row(result.recording, axis.alone.front(), "");
    for (std::size_t i = 1; i < axis.alone.size(); ++i) {
      row(result.further_recordings.at(i - 1), axis.alone[i], "");
    }
    row("all together", axis.together,
        fmt::format("{:.2g}: {}", axis.p_value, axis.holds() ? "one set serves" : "changed"));
  }
  return table;
}

std::string lead(const Characterization& result) {
  std::string doubt = recording::doubt_of_rows(result.findings);
  if (!doubt.empty()) doubt = fmt::format("Doubt: {}. ", doubt);
  return doubt + fmt::format(
                     "{:.0f} s at rest, a sample every {:.4g} s. White and flicker noise of each "
                     "axis at their "
                     "greatest likelihood through the node's own filter, at ticks of {:.4g} s.",
                     result.rest_s, static_cast<double>(result.sample_period.ns()) * 1e-9,
                     static_cast<double>(result.tick.ns()) * 1e-9);
}

}  // namespace

std::string text(const IntervalEstimate& estimate, double unit) {
  std::string value = in_figures(estimate.value * unit);
  if (estimate.standard_error == 0.0) return value;
  return fmt::format("{} [{}, {}]", value, in_figures(estimate.lo * unit),
                     in_figures(estimate.hi * unit));
}

std::string text(const std::optional<IntervalEstimate>& estimate, double unit) {
  return estimate ? text(*estimate, unit) : "not detectable";
}

std::string floor_text(const AxisCharacterization& axis) {
  if (axis.allan.empty()) return {};
  const AllanPoint& floor = axis.allan_floor();
  return fmt::format("{} [{}, {}] at {} s", in_figures(floor.adev * kDphPerRadS),
                     in_figures(floor.lo * kDphPerRadS), in_figures(floor.hi * kDphPerRadS),
                     in_figures(floor.tau_s));
}

std::string_view explain(OrderSource source) {
  switch (source) {
    case OrderSource::given:
      return "as given";
    case OrderSource::estimated:
      return "estimated from the recording";
    case OrderSource::prior:
      return "assumed: 1/f noise";
    case OrderSource::limit:
      return "at the upper limit";
  }
  return "unknown";
}

report::Report make_report(const Characterization& result, const std::string& provenance) {
  report::Report report{"Noise of " + result.recording, lead(result)};
  auto& summary = report.section("Summary");
  summary.table(coefficient_table(result)).table(model_table(result));
  const report::Table filters = filter_table(result);
  if (!filters.rows.empty()) summary.table(filters);
  if (!result.sameness.empty()) report.section("Over all recordings").table(sameness_table(result));
  for (const AxisCharacterization& axis : result.axes) {
    auto& section = report.section("Axis " + axis.axis);
    section.key_figures(key_figures(axis));
    for (const std::string& remark : axis.remarks) section.paragraph(remark);
    if (!axis.allan.empty()) section.chart(allan_chart(axis)).chart(density_chart(axis));
    section.listing(model::format_model(axis.model));
  }
  report.provenance(provenance);
  return report;
}

}  // namespace zerorate::identify
