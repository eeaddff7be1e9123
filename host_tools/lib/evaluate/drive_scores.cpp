#include "host_tools/lib/evaluate/drive_scores.hpp"

#include <fmt/format.h>
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
  drifts_rad_.push_back(outcome.drift_rad);
  if (std::abs(outcome.drift_rad) <= statistics::kHalfWidth95 * outcome.sigma_rad) ++covered_;
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

statistics::BootstrapFigure drift_ratio(const DriveScores& scores, const DriveScores& baseline) {
  const std::vector<double>& own = scores.drifts_rad();
  const std::vector<double>& other = baseline.drifts_rad();
  if (own.size() < kFewestDrivesOfARatio) return {};
  const auto ratio = [&](const std::vector<std::size_t>& drives) {
    double squares = 0.0;
    double baseline_squares = 0.0;
    for (const std::size_t drive : drives) {
      squares += own[drive] * own[drive];
      baseline_squares += other[drive] * other[drive];
    }
    return std::sqrt(squares / baseline_squares);
  };
  return statistics::bootstrap(own.size(), ratio, random::RandomStream{1}.substream("drift ratio"));
}

std::string in_words(const statistics::BootstrapFigure& ratio) {
  if (!std::isfinite(ratio.value)) return "-";
  return fmt::format("{:.3f} [{:.3f}, {:.3f}]", ratio.value, ratio.lo, ratio.hi);
}

void StopScores::add(double error_rad_s, double sigma_rad_s, double measured_s) {
  ++stops_;
  measured_s_ += measured_s;
  if (std::abs(error_rad_s) <= statistics::kHalfWidth95 * sigma_rad_s) ++covered_;
  squares_rad2_s2_ += error_rad_s * error_rad_s;
  normalised_squares_ += error_rad_s * error_rad_s / (sigma_rad_s * sigma_rad_s);
}

double StopScores::measured_s() const {
  return measured_s_ / static_cast<double>(stops_);
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
