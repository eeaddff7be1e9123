/// @file
/// Answer of the command line for a recording, and its comparison with the truth.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host_tools/lab/campaign/blind_recording.hpp"

namespace zerorate::campaign {

/// Gain of the extended model on data held out; NaN where there was nothing to measure.
struct Gain {
  double rsse_ratio = 0.0;
  double heading_drift_ratio = 0.0;
  double coverage95_base = 0.0;
  double coverage95_extended = 0.0;
  double log_score_gain_nats_per_sample = 0.0;
};

/// Certainty of a cause, as it was stated.
struct Certainty {
  double probability = 1.0;
  std::vector<std::string> set95;  ///< effects one of which is there with 95 %
};

/// Fields read from the JSON of one axis.
struct Answer {
  std::string verdict;
  std::vector<std::string> causes;        ///< strongest first
  std::vector<std::string> alternatives;  ///< alternatives of all causes
  std::vector<std::string> extensions;    ///< causes that the extended model has
  Gain gain;
  /// 95 % intervals of the parameters of each cause, by its name and theirs.
  std::map<std::string, std::map<std::string, std::pair<double, double>>> intervals;
  std::vector<Certainty> certainties;  ///< one for each cause; none: all are certain
};

/// Runs `zerorate diagnose recording --json ...` as a process of its own and reads what it wrote.
/// Throws std::runtime_error where it fails or its exit code contradicts the verdict.
[[nodiscard]] Answer diagnose(const std::filesystem::path& zerorate,
                              const std::filesystem::path& recording);

/// Verdict on drives that are consistent with a reference that errs more on the way than at rest.
inline constexpr std::string_view kReferenceDoubted = "reference doubted";

/// The answer on the drives of a recording. Throws as diagnose().
[[nodiscard]] Answer diagnose_drives(const std::filesystem::path& zerorate,
                                     const std::filesystem::path& recording);

/// Comparison of an answer with the truth.
struct Score {
  bool named = false;        ///< every hidden effect is among the causes
  bool first = false;        ///< the strongest cause is a hidden effect
  bool alone = false;        ///< and nothing but hidden effects is a cause
  bool alternative = false;  ///< a hidden effect is an alternative, but no cause
  /// "explained", by a cause that stands alone and is not hidden in it.
  bool wrong = false;
};

[[nodiscard]] Score score(const BlindRecording& blind, const Answer& answer);

}  // namespace zerorate::campaign
