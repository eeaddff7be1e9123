/// @file
/// Input of a diagnosis: one axis at rest.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "host_tools/lib/diagnose/record/input_ticks.hpp"
#include "host_tools/lib/diagnose/record/truncation.hpp"
#include "host_tools/lib/identify/rest_doubt.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::diagnose {

/// One axis at rest. Time stamps show what is missing.
struct Record {
  std::string axis;
  double sample_period_s = 0.0;  ///< median interval
  double mean_period_s = 0.0;    ///< mean interval, holes left out (see identify::RestSamples)
  std::vector<double> time_s;    ///< ascending
  std::vector<double> rate_rad_s;
  std::vector<double> temperature_degc;  ///< one for each value, or none
  std::size_t standstills = 1;      ///< standstills of the recording; this is the longest of them
  InputTicks inputs;                ///< ticks of all standstills; none without accelerations
  std::size_t index = 0;            ///< number of the axis in them
  TruncationEvidence truncation{};  ///< evidence of all axes; undone where found
  /// A bias was likely taken out upstream, and nobody has accepted it (identify::doubt::kBias).
  bool is_bias_taken_out = false;

  [[nodiscard]] std::size_t size() const { return rate_rad_s.size(); }
};

/// One axis of the longest standstill of the samples; time begins at their first one. The time
/// between standstills counts neither as lost nor as noise. A lost temperature is replaced by that
/// of the sample before. A cut toward zero is undone.
[[nodiscard]] Record record_of(const identify::RestSamples& samples, std::size_t axis);

/// Records of several axes, whose means are judged.
/// @param accepted  doubts that the user overrules
[[nodiscard]] std::vector<Record> records_of(const identify::RestSamples& samples,
                                             std::span<const std::size_t> axes,
                                             const identify::AcceptedDoubts& accepted);

/// Samples of a record in the form for averaging and characterization.
[[nodiscard]] identify::RestSamples samples_of(const Record& record);

/// Fewest samples of a record that can be diagnosed.
inline constexpr std::size_t kFewestSamples = 256;

/// The first samples of a record; all of them where it has fewer.
[[nodiscard]] Record beginning_of(const Record& record, std::size_t size);

}  // namespace zerorate::diagnose
