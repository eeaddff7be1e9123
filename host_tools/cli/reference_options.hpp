/// @file
/// The options of a reference beside the gyro: what it scores, and what it teaches.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/evaluate/true_drives.hpp"
#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/truth/truth.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the library chose the name
class App;
}  // namespace CLI

namespace zerorate::cli {

/// Options of the scores against a reference, as typed.
struct TruthFlags {
  std::string vertical_axis;
  std::optional<double> reference_error_deg;
  double reference_from_s = 0.0;
  std::string learns_from;  ///< stops, all or nothing
};

void add_truth_flags(CLI::App& app, TruthFlags& flags);
/// Throws std::invalid_argument.
[[nodiscard]] truth::TruthOptions to_truth_options(const TruthFlags& flags);

/// The true drives of a recording; nullopt where it has no reference columns, or cannot be read
/// twice. Throws std::invalid_argument, recording::Error, recording::DataError.
[[nodiscard]] std::optional<truth::Truth> read_truth(const recording::Input& input,
                                                     const TruthFlags& flags);

void add_learn_flag(CLI::App& app, TruthFlags& flags);
/// Headings that the node is to learn from; nullopt where none were asked for. Throws
/// std::invalid_argument where the recording has none.
[[nodiscard]] std::optional<evaluate::ReferenceUse> reference_use(
    const recording::Columns& columns, const TruthFlags& flags,
    const std::optional<truth::Truth>& truth);

/// Scores of the drives against the reference.
void print_true_drives(const evaluate::TrueDrives& drives, std::size_t axis_count);
/// Scale factor and offset that references taught.
void print_learnt_motion(const evaluate::LearntMotion& learnt);

}  // namespace zerorate::cli
