#include "host_tools/cli/reference_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <stdexcept>
#include <string>

#include "host_tools/cli/terminal.hpp"
#include "host_tools/lib/evaluate/true_drives_report.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::cli {
using units::kDegPerRad;
using units::kRadPerDeg;

void add_truth_flags(CLI::App& app, TruthFlags& flags) {
  app.add_option("--vertical-axis", flags.vertical_axis,
                 "axis about which the reference's heading counts: x, y, z, or -z for the other "
                 "sense, as in --vertical-axis=-z; default: found from the turns");
  app.add_option("--reference-error", flags.reference_error_deg,
                 "standard deviation of the reference's turn over a drive [deg]; default: its "
                 "change over the stops")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--reference-from", flags.reference_from_s,
                 "time of the recording before which the reference was still aligning [s]")
      ->capture_default_str();
}

truth::TruthOptions to_truth_options(const TruthFlags& flags) {
  truth::TruthOptions options{.usable_from_s = flags.reference_from_s};
  if (!flags.vertical_axis.empty()) {
    options.vertical = truth::parse_vertical_axis(flags.vertical_axis);
  }
  if (flags.reference_error_deg) {
    options.reference_error_rad = *flags.reference_error_deg * kRadPerDeg;
  }
  return options;
}

std::optional<truth::Truth> read_truth(const recording::Input& input, const TruthFlags& flags) {
  // A pipe can be read once only.
  if (!std::filesystem::is_regular_file(input.path)) return std::nullopt;
  recording::Reader reader{input};
  return truth::read_truth(reader, to_truth_options(flags));
}

void add_learn_flag(CLI::App& app, TruthFlags& flags) {
  app.add_option("--learn-from-reference", flags.learns_from,
                 "headings (ref_heading_deg) that teach the node its scale factor and its bias in "
                 "motion: one a stop, or all; each has the deviation of --reference-error over the "
                 "square root of two")
      ->check(CLI::IsMember({"stops", "all"}));
}

std::optional<evaluate::ReferenceUse> reference_use(const recording::Columns& columns,
                                                    const TruthFlags& flags,
                                                    const std::optional<truth::Truth>& truth) {
  if (flags.learns_from.empty()) return std::nullopt;
  if (!columns.ref_heading || !truth) {
    throw std::invalid_argument(
        "--learn-from-reference: the recording has no column ref_heading_deg to learn from");
  }
  if (!truth->obstacle.empty()) {
    throw std::invalid_argument("--learn-from-reference: " + truth->obstacle);
  }
  constexpr double kLeast_rad = 0.02 * kRadPerDeg;  // no reference is better
  return evaluate::ReferenceUse{
      .only_at_stops = flags.learns_from == "stops",
      .vertical = truth->vertical,
      .sigma_rad = std::max(truth->reference_error_rad * std::numbers::sqrt2 / 2.0, kLeast_rad)};
}

void print_learnt_motion(const evaluate::LearntMotion& learnt) {
  fmt::print(
      "scale factor {:+.3f} % +- {:.3f} (quality {:.2f}) and offset in motion {:+.4f} deg/s +- "
      "{:.4f}, learnt from {} headings; {} refused, {} not usable\n",
      100.0 * learnt.scale_factor, 196.0 * learnt.scale_factor_sigma, learnt.quality,
      learnt.offset_rad_s / kRadPerDeg, 1.96 * learnt.offset_sigma_rad_s / kRadPerDeg,
      learnt.learnt, learnt.refused, learnt.unusable);
}

void print_true_drives(const evaluate::TrueDrives& drives, std::size_t axis_count) {
  fmt::print("\n{}\n", evaluate::summary(drives, axis_count));
  if (!drives.truth.obstacle.empty()) return;
  fmt::print("true stops: {}, slower than {:.3g} m/s for {:g} s at least\n",
             drives.truth.stops.size(), drives.truth.speed_limit_m_s, truth::kShortestStop_s);
  for (const evaluate::ScoredTrueDrive& scored : drives.drives) {
    if (scored.flaw == truth::Flaw::none) continue;
    fmt::print("  note: the drive from {:.6g} s is not scored: {}\n",
               static_cast<double>(scored.drive.departure_ns) * 1e-9, truth::name(scored.flaw));
  }
  fmt::print("\n{:<17} {:>7} {:>14} {:>11} {:>10} {:>12} {:>12} {:>13}\n", "predictor", "drives",
             "error deg rms", "median deg", "worst deg", "coverage 95", "of the node",
             "at departure");
  for (const app::Predictor predictor : evaluate::kAllPredictors) {
    const evaluate::TrueScore score = drives.score(predictor);
    const evaluate::TrueScore departure =
        drives.score(predictor, evaluate::Scored::bias_at_departure);
    fmt::print("{:<17} {:>7} {:>14} {:>11} {:>10} {:>12} {:>12} {:>13}\n",
               evaluate::name(predictor), score.drives, cell(score.rms_rad * kDegPerRad, 4),
               cell(score.median_rad * kDegPerRad, 4), cell(score.worst_rad * kDegPerRad, 4),
               cell(score.coverage95, 3), cell(score.coverage95_of_node, 3),
               cell(departure.rms_rad * kDegPerRad, 4));
  }
}

}  // namespace zerorate::cli
