/// @file
/// Diagnosis of drives by the errors of the heading between true stops.
#pragma once

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/diagnose/drive/evidence.hpp"
#include "host_tools/lib/diagnose/result/drive_diagnosis.hpp"

namespace zerorate::diagnose {

/// Fewer drives say nothing about a cause.
inline constexpr std::size_t kFewestDrives = 6;

/// Surprisal from which on an effect is named: that of one in 660. Some eight columns are tried, so
/// that one clean recording in 80 gets a cause.
inline constexpr double kDriveThreshold_nats = 6.5;

/// @param model of the node, to which the causes that pay are added
[[nodiscard]] DriveDiagnosis diagnose_drives(const DriveRecord& record, model::SensorModel& model);

}  // namespace zerorate::diagnose
