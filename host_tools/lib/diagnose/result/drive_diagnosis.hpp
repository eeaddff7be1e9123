/// @file
/// Diagnosis of drives: what the heading errs by, the causes, and what taking them off buys.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

/// One drive for drawing.
struct DrivePoint {
  double departure_s = 0.0;
  double turn_rad = 0.0;
  double moving_s = 0.0;
  double metres = 0.0;
  double error_rad = 0.0;
  double share_rad = 0.0;  ///< share of the error by the causes
  double sigma_rad = 0.0;  ///< standard deviation of what is left, as expected
};

/// Heading on drives that the causes were not fitted to. Without drives every figure is NaN.
struct DriveGain {
  std::size_t fitted = 0;
  std::size_t held_out = 0;
  BootstrapFigure rms_before_deg;
  BootstrapFigure rms_after_deg;
  BootstrapFigure rms_ratio;  ///< after over before: below 1 is better
  BootstrapFigure log_score_nats_per_drive;
  BootstrapFigure coverage95_before;  ///< with the tolerance of the scale factor
  BootstrapFigure coverage95_after;
};

struct DriveDiagnosis {
  std::string vertical;  ///< axis about which the heading counts, such as "-z"
  std::size_t drives = 0;
  std::size_t left_out = 0;  ///< drives with a flaw of the reference or of the gyro
  std::string obstacle;      ///< reason why nothing was diagnosed; empty where it was
  Verdict verdict = Verdict::consistent;
  double rms_rad = 0.0;       ///< error of the heading
  double rms_left_rad = 0.0;  ///< without the shares of the causes
  double scatter = 0.0;       ///< standard deviation of the rest over the expected one
  std::vector<Cause> causes;  ///< strongest first
  std::vector<SelectionEvidence> evidence;
  DriveGain gain;
  std::vector<DrivePoint> points;
  std::vector<std::string> remarks;

  /// Causes that have a share in the errors, those of single drives and of the reference left out.
  [[nodiscard]] std::size_t causes_of_errors() const {
    return static_cast<std::size_t>(std::ranges::count_if(
        causes, [](const Cause& cause) { return cause.heading_drift_ratio.has_value(); }));
  }
};

}  // namespace zerorate::diagnose
