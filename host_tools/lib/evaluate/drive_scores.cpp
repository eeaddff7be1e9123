#include "host_tools/lib/evaluate/drive_scores.hpp"

#include <cmath>

namespace zerorate::evaluate {

void DriveScores::add(const Drive& drive, const core::HeadingPrediction& predicted,
                      double white_variance_rad2_s2) {
  constexpr double k95Percent = 1.959964;  // of a normal distribution, two-sided
  const auto samples = static_cast<double>(drive.samples());
  const double sample_s = drive.elapsed_s() / samples;
  const double white_rad2 = white_variance_rad2_s2 * sample_s * sample_s * samples;
  const double sigma = std::sqrt(double{predicted.variance_rad2} + white_rad2);
  ++drives_;
  if (std::abs(drive.integrated_rad()) <= k95Percent * sigma) ++covered_;
  squares_rad2_ += drive.integrated_rad() * drive.integrated_rad();
  integrated_rad_ += drive.integrated_rad();
  rsse_rad_s_ += std::sqrt(drive.squares_rad2_s2());
  sigma_rad_ += sigma;
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

}  // namespace zerorate::evaluate
