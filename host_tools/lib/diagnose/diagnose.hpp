/// @file
/// Diagnosis of a recording at rest: the errors of the simulation, their causes, and the gain of a
/// better model.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/diagnose/record/record.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

struct DiagnoseOptions {
  std::string recording;  ///< its name, for the sources of the models
  /// The model to be tested, as it stands: envelopes, misfit, adequacy and gain are against it, and
  /// the verdict is on it. The best fit of white and 1/f noise where it is absent.
  std::optional<model::SensorModel> base_model;
  double holdout = 0.3;    ///< share at the end that is held out from the fits behind the gain
  std::uint64_t seed = 1;  ///< seed of the simulations
  /// Most samples that are diagnosed, from the beginning of a record. A remark says so: memory
  /// stays below about 1 GiB an axis, time below 3 minutes.
  std::size_t most_samples = 4'000'000;
  std::function<void(double)> on_progress;  ///< share of the work that is done
  /// Called with an axis that cannot be diagnosed, and why, where another one can; unset: throws.
  std::function<void(const std::string&, const std::string&)> on_left_out;
};

/// The whole chain, docs/design/diagnosis.md, for the axes of one sensor: each by itself, and then
/// what they have in common. Deterministic. Time below 2 s for 20,000 samples and
/// about 10 s an axis for 10^6; memory grows with the samples up to DiagnoseOptions::most_samples,
/// by some 270 bytes each, and 24 bytes for those of other axes. Throws recording::DataError for
/// fewer than 256 samples and a record that is not finite, constant or nearly so.
/// @return one diagnosis an axis that was not left out
[[nodiscard]] std::vector<Diagnosis> diagnose(std::vector<Record> axes,
                                              const DiagnoseOptions& options = {});

/// Diagnoses one axis.
[[nodiscard]] Diagnosis diagnose(Record record, const DiagnoseOptions& options = {});

}  // namespace zerorate::diagnose
