/// @file
/// Diagnoses as JSON of the schema zerorate.diagnosis/1, docs/reference/diagnosis-json.md.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "host_tools/lib/diagnose/result/diagnosis.hpp"
#include "host_tools/lib/odometry/odometer_findings.hpp"

namespace zerorate::diagnose {

/// One axis: the object itself; several: a list of such objects under "axes".
/// @param odometer  what is wrong with the odometer, under "odometer"; nullptr: not examined
[[nodiscard]] std::string to_json(std::span<const Diagnosis> axes,
                                  const odometry::OdometerDiagnosis* odometer = nullptr);

}  // namespace zerorate::diagnose
