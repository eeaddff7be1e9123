/// @file
/// Diagnoses as a report with charts.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "host_tools/lib/diagnose/result/diagnosis.hpp"
#include "host_tools/lib/odometry/odometer_findings.hpp"
#include "host_tools/lib/report/report.hpp"

namespace zerorate::diagnose {

struct ReportText {
  std::string title;
  std::string recording;   ///< as a user would name it in a command
  std::string provenance;  ///< what makes the report once more
};

/// Report of each axis: the verdict in words, the causes and their parameters, Allan deviation and
/// density over what the models simulate, the effect over the data, the evidence, what the
/// extension buys, and the extended model with the commands that run it.
[[nodiscard]] report::Report make_report(std::span<const Diagnosis> axes, const ReportText& text);

/// Adds a section with what is wrong with the odometer.
void add_odometer(report::Report& report, const odometry::OdometerDiagnosis& odometer);

}  // namespace zerorate::diagnose
