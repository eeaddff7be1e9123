#include "host_tools/lib/identify/characterization_report.hpp"

#include <fmt/format.h>
#include <cmath>
#include <nlohmann/json.hpp>

#include "firmware/model/model_file.hpp"
#include "host_tools/lib/identify/model_curves.hpp"
#include "host_tools/lib/recording/json.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::identify {
namespace {

using report::Chart;
using report::Colour;
using report::Scale;

using units::kDegPerRad;
using units::kDegRtHPerRadRtS;
using units::kDphPerRadS;

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
  return {.title = "Allan deviation of axis " + axis.axis,
          .caption =
              "The falling part is white noise (angle random walk), the flat or rising one flicker "
              "noise. Where the model leaves the band the recording holds something else.",
          .x = {"Averaging time", "s", Scale::logarithmic},
          .y = {"Allan deviation", "deg/h", Scale::logarithmic},
          .series = {std::move(measured), std::move(fitted)}};
}

Chart density_chart(const AxisCharacterization& axis) {
  constexpr double kNormal95 = 1.96;
  report::Series measured{.name = "recording, 95 % interval", .colour = Colour::blue};
  report::Series fitted{.name = "fitted model", .colour = Colour::ink, .dashed = true};
  for (const DensityBin& bin : axis.density) {
    const double root = std::sqrt(bin.density) * kDegPerRad;
    // A mean of p periodogram points is chi squared with 2p degrees of freedom; on the logarithm
    // of its root the standard error is 1 / (2 sqrt(p)).
    const double spread = std::exp(0.5 * kNormal95 / std::sqrt(static_cast<double>(bin.points)));
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
              "quantization at higher frequencies are not its business.",
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
    figures.push_back({"Bias instability B", fmt::format("{:.3g} deg/h", b.value * kDphPerRadS),
                       "95 %: " + text(b, kDphPerRadS)});
    figures.push_back({"Order d", fmt::format("{:.2f}", axis.fit.flicker->order.value),
                       order_text(*axis.fit.flicker)});
  } else {
    figures.push_back({"Bias instability", "not detectable",
                       fmt::format("p = {:.2g} for flicker noise", axis.fit.p_value)});
  }
  if (!axis.allan.empty()) {
    figures.push_back({"Allan floor",
                       fmt::format("{:.3g} deg/h", axis.allan_floor().adev * kDphPerRadS),
                       fmt::format("at {:.3g} s", axis.allan_floor().tau_s)});
  }
  return figures;
}

report::Table summary_table(const Characterization& result) {
  report::Table table{
      .caption =
          "With 95 % intervals. Two-sided spectra as in IEEE Std 952: white noise N^2, flicker "
          "noise B^2 (2 pi f)^(-2d).",
      .columns = {{"Axis"},
                  {"Angle random walk N", "deg/s/sqrt(Hz)"},
                  {"Bias instability B", "deg/h"},
                  {"Order d"},
                  {"Order by local Whittle"}}};
  for (const auto& axis : result.axes) {
    const auto& flicker = axis.fit.flicker;
    const auto& whittle = axis.local_whittle_order;
    table.rows.push_back(
        {axis.axis, text(axis.fit.angle_random_walk_rad_per_sqrt_s, kDegPerRad),
         flicker ? text(flicker->bias_instability_rad_s, kDphPerRadS) : "not detectable",
         flicker ? order_text(*flicker) : "",
         whittle ? fmt::format("{:.2f} ± {:.2f}", whittle->value, whittle->standard_error) : ""});
  }
  return table;
}

report::Table sameness_table(const Characterization& result) {
  report::Table table{
      .caption = fmt::format("Does one parameter set serve all recordings? A likelihood ratio test "
                             "that errs in {:.0f} "
                             "% of the sensors that have not changed, all axes together.",
                             100.0 * Sameness::kSize),
      .columns = {{"Axis"}, {"Recording"}, {"N", "deg/s/sqrt(Hz)"}, {"B", "deg/h"}, {"p"}}};
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
  return fmt::format(
      "{:.0f} s at rest, a sample every {:.4g} s. White and flicker noise of each axis at their "
      "greatest likelihood through the node's own filter, at ticks of {:.4g} s.",
      result.rest_s, static_cast<double>(result.sample_period.ns()) * 1e-9,
      static_cast<double>(result.tick.ns()) * 1e-9);
}

}  // namespace

std::string text(const IntervalEstimate& estimate, double unit) {
  if (estimate.standard_error == 0.0) return fmt::format("{:.3g}", estimate.value * unit);
  return fmt::format("{:.3g} [{:.3g}, {:.3g}]", estimate.value * unit, estimate.lo * unit,
                     estimate.hi * unit);
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
  report.section("Summary").table(summary_table(result));
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

namespace {

using Json = nlohmann::ordered_json;
using recording::number;

using units::kDegPerRad;
using units::kDegRtHPerRadRtS;
using units::kDphPerRadS;

Json interval(const IntervalEstimate& estimate, double unit) {
  return {{"value", number(estimate.value * unit)},
          {"standard_error", number(estimate.standard_error * unit)},
          {"lo95", number(estimate.lo * unit)},
          {"hi95", number(estimate.hi * unit)}};
}

Json flicker_json(const FittedFlicker& flicker) {
  Json order = interval(flicker.order, 1.0);
  order["source"] = name(flicker.order_source);
  Json json{{"bias_instability_dph", interval(flicker.bias_instability_rad_s, kDphPerRadS)},
            {"order", std::move(order)}};
  if (flicker.rejected_order) json["rejected_order"] = interval(*flicker.rejected_order, 1.0);
  return json;
}

Json allan_json(const std::vector<AllanPoint>& points) {
  Json json = Json::array();
  for (const AllanPoint& point : points) {
    json.push_back({{"tau_s", point.tau_s},
                    {"adev_dph", number(point.adev * kDphPerRadS)},
                    {"lo95_dph", number(point.lo * kDphPerRadS)},
                    {"hi95_dph", number(point.hi * kDphPerRadS)},
                    {"edf", number(point.edf)}});
  }
  return json;
}

Json density_json(const std::vector<DensityBin>& bins) {
  Json json = Json::array();
  for (const DensityBin& bin : bins) {
    json.push_back({{"frequency_hz", bin.frequency_hz},
                    {"density_dps2_per_hz", number(bin.density * kDegPerRad * kDegPerRad)},
                    {"points", bin.points}});
  }
  return json;
}

Json strengths_json(const InnovationsFit& fit) {
  return {{"angle_random_walk_dps_per_sqrt_hz",
           interval(fit.angle_random_walk_rad_per_sqrt_s, kDegPerRad)},
          {"flicker", fit.flicker ? flicker_json(*fit.flicker) : Json(nullptr)}};
}

Json sameness_json(const Characterization& result) {
  Json json{{"recordings", {result.recording}},
            {"size", Sameness::kSize},
            {"serves", true},
            {"axes", Json::object()}};
  for (const std::string& more : result.further_recordings) json["recordings"].push_back(more);
  for (const Sameness& axis : result.sameness) {
    if (!axis.holds()) json["serves"] = false;
    Json alone = Json::array();
    for (const InnovationsFit& fit : axis.alone) alone.push_back(strengths_json(fit));
    json["axes"][axis.axis] = {{"serves", axis.holds()},
                               {"p_value", number(axis.p_value)},
                               {"likelihood_ratio", number(axis.likelihood_ratio)},
                               {"degrees_of_freedom", axis.degrees_of_freedom},
                               {"together", strengths_json(axis.together)},
                               {"alone", std::move(alone)}};
  }
  return json;
}

Json axis_json(const AxisCharacterization& axis) {
  const InnovationsFit& fit = axis.fit;
  Json json{{"angle_random_walk_dps_per_sqrt_hz",
             interval(fit.angle_random_walk_rad_per_sqrt_s, kDegPerRad)},
            {"angle_random_walk_deg_per_sqrt_h",
             interval(fit.angle_random_walk_rad_per_sqrt_s, kDegRtHPerRadRtS)},
            {"flicker", fit.flicker ? flicker_json(*fit.flicker) : Json(nullptr)},
            {"flicker_likelihood_ratio", number(fit.likelihood_ratio)},
            {"flicker_p_value", number(fit.p_value)},
            {"minus_two_log_likelihood", number(fit.minus_two_log_likelihood)},
            {"local_whittle_order", nullptr},
            {"allan_floor", nullptr}};
  if (axis.local_whittle_order) {
    json["local_whittle_order"] = {{"value", axis.local_whittle_order->value},
                                   {"standard_error", axis.local_whittle_order->standard_error}};
  }
  if (!axis.allan.empty()) {
    const AllanPoint& floor = axis.allan_floor();
    json["allan_floor"] = {{"adev_dph", number(floor.adev * kDphPerRadS)}, {"tau_s", floor.tau_s}};
  }
  json["remarks"] = axis.remarks;
  json["allan_deviation"] = allan_json(axis.allan);
  json["density"] = density_json(axis.density);
  return json;
}

}  // namespace

std::string_view name(OrderSource source) {
  switch (source) {
    case OrderSource::given:
      return "given";
    case OrderSource::estimated:
      return "estimated";
    case OrderSource::prior:
      return "prior";
    case OrderSource::limit:
      return "limit";
  }
  return "unknown";
}

std::string to_json(const Characterization& result) {
  Json json{{"schema", "zerorate.characterization/1"},
            {"recording", result.recording},
            {"rows", result.rows},
            {"rows_moving", result.rows_moving},
            {"rows_lost", result.rows_lost},
            {"findings", recording::to_json(result.findings)},
            {"sample_period_s", static_cast<double>(result.sample_period.ns()) * 1e-9},
            {"tick_s", static_cast<double>(result.tick.ns()) * 1e-9},
            {"ticks", result.ticks},
            {"rest_s", result.rest_s},
            {"middle_axis", middle_axis(result).axis},
            {"axes", Json::object()}};
  for (const AxisCharacterization& axis : result.axes) json["axes"][axis.axis] = axis_json(axis);
  if (!result.sameness.empty()) json["one_parameter_set"] = sameness_json(result);
  return json.dump(2) + "\n";
}

}  // namespace zerorate::identify
