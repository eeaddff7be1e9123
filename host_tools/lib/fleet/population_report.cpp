// A population to look at.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "host_tools/lib/fleet/presentation.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::fleet {
namespace {

std::string names_of_reference(const Population& population) {
  std::string names;
  for (const Lot& lot : population.lots) {
    if (!lot.is_reference) continue;
    names +=
        (names.empty() ? "" : ", ") + (lot.name.empty() ? std::string{"without a name"} : lot.name);
  }
  return names;
}

report::Table distribution_table(const Population& population) {
  report::Table table{.caption =
                          "The spread is that of the sensors: errors of the recordings are "
                          "not in it.",
                      .columns = {{"Figure"},
                                  {"Unit"},
                                  {"Median", "", 5},
                                  {"1 of 40 below", "", 5},
                                  {"1 of 40 above", "", 5},
                                  {"Spread", "of ln N, ln B, d", 3},
                                  {"Error of the mean", "of ln N, ln B, d", 4}}};
  for (int i = 0; i < kCoordinates; ++i) {
    const Shown& one = shown()[static_cast<std::size_t>(i)];
    table.rows.push_back({one.name, one.unit, at(population, i, 0.0),
                          at(population, i, -statistics::kHalfWidth95),
                          at(population, i, statistics::kHalfWidth95), population.spread(i),
                          population.mean_error[i]});
  }
  return table;
}

/// Shares of the sensors' estimates in bins beside what the fitted distribution expects.
report::Chart histogram(const Population& population, int coordinate) {
  constexpr int kBins = 24;
  constexpr double kReach = 4.0;  // spreads
  const Shown& one = shown()[static_cast<std::size_t>(coordinate)];
  const double spread = population.spread(coordinate);
  const auto middle_of = [](int bin) { return ((2.0 * bin + 1.0) / kBins - 1.0) * kReach; };
  std::vector<double> counts(kBins);
  std::vector<double> expected(kBins);
  for (const Member& member : population.members) {
    const Profile& measured = member.profiles[static_cast<std::size_t>(coordinate)];
    const double sigmas = (measured.best - population.distribution.mean[coordinate]) / spread;
    const double error = (measured.hi - measured.lo) / (2.0 * statistics::kHalfWidth95 * spread);
    const double width = std::hypot(1.0, error);
    for (int bin = 0; bin < kBins; ++bin) {
      const double from_mean = middle_of(bin) / width;
      expected[static_cast<std::size_t>(bin)] += 2.0 * kReach / kBins / width *
                                                 std::exp(-0.5 * from_mean * from_mean) /
                                                 std::sqrt(2.0 * std::numbers::pi);
    }
    const auto bin = static_cast<int>(std::floor((sigmas / kReach + 1.0) * 0.5 * kBins));
    counts[static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1))] += 1.0;
  }
  report::Series axes{.name = "Axes", .style = report::SeriesStyle::steps};
  report::Series fitted{.name = "Fitted distribution with the errors of the recordings",
                        .dashed = true};
  for (int bin = 0; bin < kBins; ++bin) {
    const double left = (2.0 * bin / kBins - 1.0) * kReach;
    axes.x.push_back(at(population, coordinate, left));
    axes.y.push_back(counts[static_cast<std::size_t>(bin)]);
    fitted.x.push_back(at(population, coordinate, middle_of(bin)));
    fitted.y.push_back(expected[static_cast<std::size_t>(bin)]);
  }
  return {
      .title = one.name,
      .caption =
          "Likeliest figure of each axis by its recording alone; the last bins hold all that is "
          "farther away.",
      .x = {one.name, one.unit, one.is_log ? report::Scale::logarithmic : report::Scale::linear},
      .y = {"Axes"},
      .series = {std::move(axes), std::move(fitted)}};
}

report::Table effect_table(const Population& population) {
  report::Table table{.columns = {{"Effect"}, {"Axes"}, {"Sensors"}, {"Taken for"}}};
  for (const EffectCount& effect : population.effects) {
    table.rows.push_back({effect.effect, effect.axes, effect.sensors,
                          effect.is_common ? "a property of the type" : "a reason to leave"});
  }
  return table;
}

report::Table lot_table(const Population& population) {
  report::Table table{
      .caption = "The reference are the lots that agree with each other: " +
                 names_of_reference(population) +
                 ". A lot of the reference is compared with the others of it. The difference has "
                 "its 95 % interval; p is that of the figure, q the false discovery rate at which "
                 "the lot is named.",
      .columns = {{"Lot"},
                  {"Figure"},
                  {"Lot", "", 5},
                  {"Reference", "", 5},
                  {"Difference"},
                  {"Differs"},
                  {"p"},
                  {"q"}}};
  constexpr std::size_t kMostRows = 40;
  for (const LotFigure& figure : population.lot_figures) {
    if (table.rows.size() == kMostRows) break;
    table.rows.push_back(
        {population.lots[figure.lot].name, figure.what, in_unit(figure, figure.lot_value),
         in_unit(figure, figure.other_value), effect_text(figure), figure.differs ? "yes" : "",
         rate_text(figure.p_value), rate_text(population.lots[figure.lot].q_value)});
  }
  return table;
}

report::Table outlier_table(const Population& population) {
  report::Table table{.columns = {{"Sensor"}, {"Lot"}, {"Reason"}, {"q"}}};
  for (const Sensor* sensor : outliers(population)) {
    table.rows.push_back({sensor->name, population.lots[sensor->lot].name,
                          words(sensor->reasons.front()), rate_text(sensor->q_value)});
  }
  return table;
}

}  // namespace

report::Report make_report(const Population& population, const std::string& provenance) {
  std::string lead = lead_of(population);
  if (population.quality && population.quality->has_limits) {
    lead = words(population, *population.quality) + " " + lead;
  }
  report::Report report{"Population of a fleet", lead};
  for (const std::string& warning : population.warnings)
    report.section("Warning").paragraph(warning);
  if (population.quality) add_quality(population, *population.quality, report);
  report::Section& distributions = report.section("Distributions");
  distributions.table(distribution_table(population));
  for (int i = 0; i < kCoordinates; ++i) {
    report::Chart chart = histogram(population, i);
    if (population.quality) {
      shade_limits(*population.quality, static_cast<std::size_t>(i), chart);
    }
    distributions.chart(chart);
  }
  const std::vector<double> slopes = temperature_slopes(population);
  if (!slopes.empty()) {
    distributions.paragraph(fmt::format(
        "On {} axes the bias follows the temperature: median {:.3g} deg/h/K, half of them between "
        "{:.3g} and {:.3g}.",
        slopes.size(), statistics::quantile_of_sorted(slopes, 0.5),
        statistics::quantile_of_sorted(slopes, 0.25),
        statistics::quantile_of_sorted(slopes, 0.75)));
  }
  if (!population.effects.empty()) {
    report::BarChart bars{.title = "Axes with an effect", .y = {"Axes"}};
    report::BarGroup axes{.name = "Axes"};
    for (const EffectCount& effect : population.effects) {
      bars.categories.push_back(effect.effect);
      axes.values.push_back(static_cast<double>(effect.axes));
    }
    bars.groups.push_back(std::move(axes));
    report.section("Causes").chart(bars).table(effect_table(population));
  }
  report::Section& leaving = report.section("Sensors that leave the population");
  if (outliers(population).empty()) {
    leaving.paragraph("None.");
  } else {
    leaving.table(outlier_table(population));
  }
  if (!population.lot_figures.empty()) report.section("Lots").table(lot_table(population));
  const auto changes = changed(population);
  if (!changes.empty()) {
    report::Table table{.columns = {{"Sensor"}, {"Recordings"}, {"q"}}};
    for (const Sensor* sensor : changes) {
      table.rows.push_back({sensor->name, sensor->recordings, rate_text(sensor->change_q_value)});
    }
    report.section("Sensors that changed between recordings").table(table);
  }
  if (!population.bad.empty()) {
    report::Table table{.columns = {{"Recording"}, {"What was not used or was repaired, and why"}}};
    for (const StoredRecording& one : population.bad) {
      table.rows.push_back({one.entry.name, one.problem});
    }
    report.section("Recordings that could not be used as they stand").table(table);
  }
  report.provenance(provenance);
  return report;
}

}  // namespace zerorate::fleet
