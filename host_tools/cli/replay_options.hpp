/// @file
/// The options that `replay` and `demo` share.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/truth/truth.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the library chose the name
class App;
class Option;
}  // namespace CLI

namespace zerorate::cli {

/// Options as typed; to_replay_options() turns them into evaluate::ReplayOptions.
struct ReplayFlags {
  std::string axis;  ///< empty: see shown_axes()
  std::string model = "adis16405";
  const CLI::Option* model_option = nullptr;  ///< whether it was given
  std::optional<double> arw_dps_rt_hz;
  std::optional<double> bias_instability_dph;
  std::string schedule;
  std::string through = "source";
  std::optional<std::string> chip;  ///< value of --through chip
  std::string predictor = "kalman";
  std::optional<double> sample_rate_hz;
  std::optional<double> filter_rate_hz;
  double settle_s = 1.0;
  double hold_back_s = 0.5;
  std::string still_from = "odometer";
  std::optional<double> latitude_deg;
  std::string up;
  bool trusts_model = false;
};

void add_replay_flags(CLI::App& app, ReplayFlags& flags);

/// Axes that --axis names, all if nothing was asked for. Throws std::invalid_argument.
[[nodiscard]] std::vector<std::size_t> scored_axes(const ReplayFlags& flags,
                                                   std::size_t axis_count);
/// Axes for people to read, the vertical one first: that of the reference, else z. Without --axis a
/// drive shows the vertical one alone. Throws std::invalid_argument.
[[nodiscard]] std::vector<std::size_t> shown_axes(const ReplayFlags& flags, std::size_t axis_count,
                                                  const std::optional<truth::Truth>& truth);

/// Throws std::invalid_argument, model::ModelFileError.
[[nodiscard]] evaluate::ReplayOptions to_replay_options(const ReplayFlags& flags);

/// Prints oddities of a recording as notes for a terminal.
void print_doubt_of_rows(const recording::Findings& findings);
void print_findings(const recording::Findings& findings);

/// Prints one line where the vertical axis is shown alone without having been asked for.
void print_what_is_not_shown(const ReplayFlags& flags, const evaluate::ReplayResult& result,
                             const std::vector<std::size_t>& axes);

/// Prints what the node published and its scores, as text for a terminal.
void print_result(const evaluate::ReplayResult& result, const std::vector<std::size_t>& axes);

}  // namespace zerorate::cli
