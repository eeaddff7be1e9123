/// @file
/// How well a predictor did over the drives of a replay.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/estimator/prediction.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::evaluate {

/// Sums over one drive of one axis and predictor.
class Drive {
 public:
  /// @param error_rad_s corrected rate minus true rate; @param elapsed_s since the sample before
  void add(double error_rad_s, double elapsed_s) {
    integrated_rad_ += error_rad_s * elapsed_s;
    squares_rad2_s2_ += error_rad_s * error_rad_s;
    elapsed_s_ += elapsed_s;
    ++samples_;
  }

  [[nodiscard]] std::size_t samples() const { return samples_; }
  [[nodiscard]] double elapsed_s() const { return elapsed_s_; }
  /// The heading drift of the drive: the paper's integrated error (IE) times the sample period.
  [[nodiscard]] double integrated_rad() const { return integrated_rad_; }
  [[nodiscard]] double squares_rad2_s2() const { return squares_rad2_s2_; }

 private:
  double integrated_rad_ = 0.0;
  double squares_rad2_s2_ = 0.0;
  double elapsed_s_ = 0.0;
  std::size_t samples_ = 0;
};

/// Outcome of a drive against its prediction.
struct DriveOutcome {
  double drift_rad = 0.0;   ///< integrated corrected rate minus the true turn
  double sigma_rad = 0.0;   ///< predicted standard deviation of the drift, white noise included
  double rsse_rad_s = 0.0;  ///< root sum of squared errors (the paper's RSSE)
};

/// @param predicted the predictor's heading interval for this drive, without white noise
/// @param white_variance_rad2_s2 of one sample: the angle random walk adds to the interval
[[nodiscard]] DriveOutcome outcome(const Drive& drive, const core::HeadingPrediction& predicted,
                                   double white_variance_rad2_s2);

/// Drives of one axis and predictor. Without drives every figure is NaN. Takes 8 bytes a drive.
class DriveScores {
 public:
  void add(const DriveOutcome& outcome);

  [[nodiscard]] std::size_t drives() const { return drifts_rad_.size(); }
  [[nodiscard]] const std::vector<double>& drifts_rad() const { return drifts_rad_; }
  [[nodiscard]] double heading_drift_rms_rad() const;
  [[nodiscard]] double mean_integrated_rad() const;
  /// Mean over the drives of the paper's root sum of squared errors (RSSE) [rad/s].
  [[nodiscard]] double mean_rsse_rad_s() const;
  /// Share of the drives whose drift lies within 1.96 predicted standard deviations.
  [[nodiscard]] double coverage95() const;
  /// Mean predicted standard deviation over the root mean square of the drift. Honest is 1 for
  /// drives of equal length, less if lengths differ (0.7 to 0.8 for exponential ones).
  [[nodiscard]] double sigma_over_rms() const;

 private:
  [[nodiscard]] double mean(double sum) const { return sum / static_cast<double>(drives()); }

  std::vector<double> drifts_rad_;
  std::size_t covered_ = 0;
  double squares_rad2_ = 0.0;
  double integrated_rad_ = 0.0;
  double rsse_rad_s_ = 0.0;
  double sigma_rad_ = 0.0;
};

/// Fewer drives give a ratio no interval, and therefore no ratio.
inline constexpr std::size_t kFewestDrivesOfARatio = 5;

/// Heading drift rms over that of a baseline on the same drives, with its 95 % interval by drawing
/// drives with replacement: 2000 draws, always the same. NaN below kFewestDrivesOfARatio drives.
[[nodiscard]] statistics::BootstrapFigure drift_ratio(const DriveScores& scores,
                                                      const DriveScores& baseline);
/// Ratio and interval with three decimals, as in 0.663 [0.551, 0.783]; "-" for NaN.
[[nodiscard]] std::string in_words(const statistics::BootstrapFigure& ratio);

/// Predicted biases against what the first seconds of the stops then measured: scores that need no
/// truth. Without stops every figure is NaN.
class StopScores {
 public:
  /// @param error_rad_s  mean that a stop measured less the predicted one
  /// @param sigma_rad_s  standard deviation of the error as predicted, white noise included
  /// @param measured_s  time over which the stop was measured
  void add(double error_rad_s, double sigma_rad_s, double measured_s);

  [[nodiscard]] std::size_t stops() const { return stops_; }
  /// Mean of the times over which the stops were measured.
  [[nodiscard]] double measured_s() const;
  [[nodiscard]] double error_rms_rad_s() const;
  /// Root mean square of the errors in units of their predicted sigma: 1 where the interval is
  /// honest.
  [[nodiscard]] double error_rms_sigmas() const;
  /// Share of the stops whose error lies within 1.96 predicted sigmas.
  [[nodiscard]] double coverage95() const;

 private:
  std::size_t stops_ = 0;
  std::size_t covered_ = 0;
  double squares_rad2_s2_ = 0.0;
  double normalised_squares_ = 0.0;
  double measured_s_ = 0.0;
};

}  // namespace zerorate::evaluate
