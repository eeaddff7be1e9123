/// @file
/// Diagnosis of drives by the errors of the heading between true stops.
#pragma once

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/diagnose/drive/evidence.hpp"
#include "host_tools/lib/diagnose/result/drive_diagnosis.hpp"

namespace zerorate::diagnose {

/// Fewer drives say nothing about a cause.
inline constexpr std::size_t kFewestDrives = 6;

/// Least surprisal of an effect that is named, one in 660. With some eight columns to try, one
/// recording without an effect in 80 gets a cause by chance.
inline constexpr double kDriveThreshold_nats = 6.5;

/// @param model of the node, to which the causes that pay are added
[[nodiscard]] DriveDiagnosis diagnose_drives(const DriveRecord& record, model::SensorModel& model);

}  // namespace zerorate::diagnose
