#include "host_tools/lib/evaluate/drive_scores.hpp"

#include <cmath>

namespace zerorate::evaluate {

DriveOutcome outcome(const Drive& drive, const core::HeadingPrediction& predicted,
                     double white_variance_rad2_s2) {
  const auto samples = static_cast<double>(drive.samples());
  const double sample_s = drive.elapsed_s() / samples;
  const double white_rad2 = white_variance_rad2_s2 * sample_s * sample_s * samples;
  return {.drift_rad = drive.integrated_rad(),
          .sigma_rad = std::sqrt(double{predicted.variance_rad2} + white_rad2),
          .rsse_rad_s = std::sqrt(drive.squares_rad2_s2())};
}

void DriveScores::add(const DriveOutcome& outcome) {
  ++drives_;
  if (std::abs(outcome.drift_rad) <= k95Percent * outcome.sigma_rad) ++covered_;
  squares_rad2_ += outcome.drift_rad * outcome.drift_rad;
  integrated_rad_ += outcome.drift_rad;
  rsse_rad_s_ += outcome.rsse_rad_s;
  sigma_rad_ += outcome.sigma_rad;
}

double DriveScores::heading_drift_rms_rad() const {
  return std::sqrt(mean(squares_rad2_));
}
double DriveScores::mean_integrated_rad() const {
  return mean(integrated_rad_);
}
double DriveScores::mean_rsse_rad_s() const {
  return mean(rsse_rad_s_);
}
double DriveScores::coverage95() const {
  return mean(static_cast<double>(covered_));
}
double DriveScores::sigma_over_rms() const {
  return mean(sigma_rad_) / heading_drift_rms_rad();
}

void StopScores::add(double error_rad_s, double sigma_rad_s) {
  ++stops_;
  if (std::abs(error_rad_s) <= k95Percent * sigma_rad_s) ++covered_;
  squares_rad2_s2_ += error_rad_s * error_rad_s;
  normalised_squares_ += error_rad_s * error_rad_s / (sigma_rad_s * sigma_rad_s);
}

double StopScores::error_rms_rad_s() const {
  return std::sqrt(squares_rad2_s2_ / static_cast<double>(stops_));
}
double StopScores::error_rms_sigmas() const {
  return std::sqrt(normalised_squares_ / static_cast<double>(stops_));
}
double StopScores::coverage95() const {
  return static_cast<double>(covered_) / static_cast<double>(stops_);
}

}  // namespace zerorate::evaluate
