/// @file
/// Hours of drives in streets that are made, and their diagnosis.
#pragma once

#include <cstdint>

#include "host_tools/lib/diagnose/result/drive_diagnosis.hpp"
#include "host_tools/lib/simulate/scenario.hpp"

namespace zerorate::diagnose {

struct HourOptions {
  simulate::MotionErrors errors{};
  double per_g_rad_s = 0.0;  ///< sensitivity of z to the force along each axis
  double length_s = 3600.0;
};

/// Streets with grades of 3 %, rows at 25 Hz with accelerations and an exact reference.
[[nodiscard]] simulate::ScenarioDrive made_hour(std::uint64_t seed, const HourOptions& options);

/// Diagnosis as by `zerorate diagnose`, with the noise of the catalogue's model.
[[nodiscard]] DriveDiagnosis diagnosis_of(const simulate::ScenarioDrive& drive);

}  // namespace zerorate::diagnose
