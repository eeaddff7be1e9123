/// @file
/// Diagnosis of hours of drives that were made.
#pragma once

#include "host_tools/lib/diagnose/result/drive_diagnosis.hpp"
#include "host_tools/lib/simulate/scenario.hpp"

namespace zerorate::diagnose {

/// Diagnosis as by `zerorate diagnose`, with the noise of the catalogue's model.
[[nodiscard]] DriveDiagnosis diagnosis_of(const simulate::ScenarioDrive& drive);

}  // namespace zerorate::diagnose
