#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/terminal.hpp"
#include "host_tools/lib/odometry/odometer_figures.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::cli {
namespace {

struct OdometerOptions {
  std::string recording;
  std::string json;
};

void print_figure(std::string_view what, const std::string& figure, std::string_view remark = "") {
  fmt::print("  {:<27} {:<27} {}\n", what, figure, remark);
}

std::string text(const odometry::BootstrapFigure& figure, double unit = 1.0) {
  return fmt::format("{:.3g} [{:.3g}, {:.3g}]", figure.value * unit, figure.lo * unit,
                     figure.hi * unit);
}

/// Median with its interval; range of the middle 90 %.
void print_sample(std::string_view what, const odometry::Sample& sample, std::string_view unit) {
  if (sample.sorted.empty()) return;
  using statistics::quantile_of_sorted;
  print_figure(what, text(sample.median),
               fmt::format("{}; 5 to 95 %: {:.3g} to {:.3g}; {} times", unit,
                           quantile_of_sorted(sample.sorted, 0.05),
                           quantile_of_sorted(sample.sorted, 0.95), sample.sorted.size()));
}

void print_zero(const odometry::SpeedRecord& record, const odometry::OdometerFigures& figures) {
  fmt::print("\nzero and not zero\n");
  if (figures.smallest_m_s) {
    print_figure("smallest speed but 0", fmt::format("{:.3g}", *figures.smallest_m_s), "m/s");
  }
  print_sample("leaves 0 at a true", figures.leaves_zero_m_s, "m/s");
  print_sample("reaches 0 at a true", figures.reaches_zero_m_s, "m/s");
  print_sample("stays above 0 for", figures.holds_s, "s below the smallest speed");
  if (figures.step_m_s) print_figure("step", fmt::format("{:.3g}", *figures.step_m_s), "m/s");
  if (record.counts_pulses) {
    print_figure("metres a pulse", fmt::format("{:.5g}", record.metres_per_pulse),
                 "by the distance of the reference");
  }
}

void print_time(const odometry::OdometerFigures& figures) {
  print_figure("late by", text(figures.latency_s), "s");
  print_figure("scale", text(figures.scale), "odometer over reference");
  print_sample("new speed every", figures.renewal_s, "s while braking or pulling away hard");
}

void print_turning(std::string_view what, const std::vector<double>& sorted_rad_s) {
  if (sorted_rad_s.empty()) return;
  const auto dps = [&](double p) {
    return statistics::quantile_of_sorted(sorted_rad_s, p) * units::kDegPerRad;
  };
  print_figure(what, fmt::format("{:.3g}, {:.3g}, {:.3g}", dps(0.5), dps(0.95), dps(1.0)),
               "deg/s: median, 95 %, most");
}

void print_rolling(std::string_view what, const odometry::Rolling& rolling) {
  if (rolling.rows == 0) return;
  print_figure(what, text(rolling.share, 100.0) + " %",
               fmt::format("of the time at 0; at {:.2g} m/s, at most {:.2g}",
                           statistics::quantile_of_sorted(rolling.speeds_m_s, 0.5),
                           rolling.speeds_m_s.back()));
  print_turning("  turning at", rolling.turning_rad_s);
}

void print_figures(const odometry::SpeedRecord& record, const odometry::OdometerFigures& figures) {
  fmt::print("{}: {} rows every {:.3g} s, {:.0f} s; {:.1f} % of them at 0\n", record.name,
             record.size(), figures.rows_s, figures.duration_s, 100.0 * figures.silent_share);
  if (record.rows_lost > 0) fmt::print("  note: {} rows without both speeds\n", record.rows_lost);
  if (!record.gap_before.empty()) fmt::print("  note: {} gaps\n", record.gap_before.size());
  fmt::print("Figures in brackets are 95 % intervals.\n");
  print_zero(record, figures);
  print_time(figures);
  fmt::print("\nrolling at more than {} m/s while the odometer reads 0\n", odometry::kStanding_m_s);
  print_rolling("all", figures.rolling);
  constexpr std::array kWords{"last metres before a stop", "first metres after it",
                              "inching between", "passing without a stop"};
  for (std::size_t i = 0; i < kWords.size(); ++i) {
    print_rolling(kWords[i], figures.rolling_by_situation[i]);
  }
  print_turning("turning at true rest", figures.standing_turning_rad_s);
  fmt::print("\nstops of 2 s and more, and drives between them\n");
  print_sample("true stops", figures.true_stops_s, "s");
  print_sample("stops by the odometer", figures.odometer_stops_s, "s");
  print_sample("true drives", figures.true_drives_s, "s");
  print_sample("drives by the odometer", figures.odometer_drives_s, "s");
  print_sample("brakes with", figures.braking_m_s2, "m/s2, the last 2 s");
  print_sample("pulls away with", figures.pulling_away_m_s2, "m/s2, the first 2 s");
}

ExitCode run_odometer(const OdometerOptions& options) {
  const odometry::SpeedRecord record = odometry::read_speed_record(options.recording);
  const odometry::OdometerFigures figures = odometry::measure_odometer(record);
  if (!options.json.empty()) write_text(options.json, odometry::to_json(record, figures));
  if (options.json != "-") print_figures(record, figures);
  return success;
}

}  // namespace

Command add_odometer(CLI::App& app) {
  auto* command = app.add_subcommand("odometer", "Measure an odometer against a reference's speed");
  const auto options = std::make_shared<OdometerOptions>();
  command->add_option("RECORDING", options->recording, "CSV or CSV.gz file; - for standard input")
      ->required();
  command->add_option("--json", options->json, "write the figures as JSON; - for standard output");
  command->footer(
      "Columns: t_s, ref_speed_mps, and odometer_speed_mps, obd_speed_mps or odometer_pulses; for\n"
      "turning ref_rate_dps or gz_dps. Other columns are not read.\n"
      "Examples:\n"
      "  zerorate odometer drive.csv.gz\n"
      "  zerorate odometer drive.csv.gz --json odometer.json\n"
      "Cars in traffic: docs/reference/real-odometers.md. The JSON: "
      "docs/reference/odometer-json.md.");
  return {command, [options] { return run_odometer(*options); }};
}

}  // namespace zerorate::cli
