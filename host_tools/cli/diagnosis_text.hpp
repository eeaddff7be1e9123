/// @file
/// A diagnosis as text of the command line.
#pragma once

#include <vector>

#include "host_tools/lib/diagnose/result/diagnosis.hpp"
#include "host_tools/lib/diagnose/result/drive_diagnosis.hpp"
#include "host_tools/lib/odometry/odometer_findings.hpp"

namespace zerorate::cli {

void print_odometer(const odometry::OdometerDiagnosis& odometer);

/// One line an axis and one of the drives: what a reader in a hurry takes away.
/// @param drives nullptr: none
void print_verdicts(const std::vector<diagnose::Diagnosis>& diagnoses,
                    const diagnose::DriveDiagnosis* drives);

void print_diagnosis(const diagnose::Diagnosis& diagnosis, bool is_verbose);

/// The drives, and the causes of rest and motion in the order of what they cost the heading.
void print_drives(const diagnose::DriveDiagnosis& drives,
                  const std::vector<diagnose::Diagnosis>& diagnoses, bool is_verbose);

}  // namespace zerorate::cli
