#include "host_tools/lib/diagnose/drive/drive_gain.hpp"

#include <cmath>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

/// A drive held out.
struct HeldOut {
  double error_rad = 0.0;
  double share_rad = 0.0;    ///< predicted by the causes
  double before_rad2 = 0.0;  ///< variance that is expected without them
  double after_rad2 = 0.0;   ///< with them, their own errors included
};

/// The drives that are scored by a fit to others.
struct Fold {
  std::vector<std::size_t> fitted;
  std::vector<std::size_t> scored;
};

std::vector<Fold> folds_of(std::size_t drives) {
  constexpr std::size_t kFewestToSplit = 12;
  std::vector<Fold> folds;
  if (drives >= kFewestToSplit) {
    Fold fold;
    for (std::size_t k = 0; k < drives; ++k) {
      (3 * k < 2 * drives ? fold.fitted : fold.scored).push_back(k);
    }
    return {fold};
  }
  for (std::size_t left = 0; left < drives; ++left) {
    Fold fold{.fitted = {}, .scored = {left}};
    for (std::size_t k = 0; k < drives; ++k) {
      if (k != left) fold.fitted.push_back(k);
    }
    folds.push_back(std::move(fold));
  }
  return folds;
}

/// @param tolerance of the scale factor in the variance before
std::vector<HeldOut> hold_out(const DriveRecord& record, const std::vector<MotionChoice>& choices,
                              double tolerance) {
  const Share share = joint_share(choices, record);
  const Eigen::MatrixXd covariance = record.covariance();
  std::vector<HeldOut> all;
  for (const Fold& fold : folds_of(record.size())) {
    const DriveFit fit = DriveRegression(picked(record, fold.fitted))
                             .fit(picked(share, record.rows_of(fold.fitted)));
    for (const std::size_t k : fold.scored) {
      const auto row = static_cast<Eigen::Index>(k);
      const DriveEvidence& drive = record.drives[k];
      HeldOut one{.error_rad = drive.error_rad,
                  .share_rad = share.known[row],
                  .before_rad2 = covariance(row, row) + std::pow(tolerance * drive.turn_rad, 2),
                  .after_rad2 = covariance(row, row)};
      if (share.columns.cols() > 0) {
        const Eigen::VectorXd x = share.columns.row(row).transpose();
        one.share_rad += x.dot(fit.coefficients);
        one.after_rad2 += x.dot(fit.covariance * x);
      }
      all.push_back(one);
    }
  }
  return all;
}

double rms(const std::vector<double>& values, const std::vector<std::size_t>& indices) {
  double squares = 0.0;
  for (const std::size_t i : indices) squares += values[i] * values[i];
  return std::sqrt(squares / static_cast<double>(indices.size()));
}

/// Errors that are left on the drives held out.
std::vector<double> left_by(const std::vector<HeldOut>& drives) {
  std::vector<double> left;
  left.reserve(drives.size());
  for (const HeldOut& drive : drives) left.push_back(drive.error_rad - drive.share_rad);
  return left;
}

BootstrapFigure drawn(std::size_t size, const statistics::Statistic& statistic) {
  return statistics::bootstrap(size, statistic, random::RandomStream{1}.substream("drives"));
}

BootstrapFigure mean_of(const std::vector<double>& values) {
  return drawn(values.size(), [&](const std::vector<std::size_t>& indices) {
    double sum = 0.0;
    for (const std::size_t i : indices) sum += values[i];
    return sum / static_cast<double>(indices.size());
  });
}

BootstrapFigure ratio_of(const std::vector<double>& after, const std::vector<double>& before) {
  return drawn(after.size(), [&](const std::vector<std::size_t>& indices) {
    return rms(after, indices) / rms(before, indices);
  });
}

}  // namespace

DriveGain measure_drive_gain(const DriveRecord& record, const std::vector<MotionChoice>& choices,
                             double tolerance) {
  const std::vector<HeldOut> drives = hold_out(record, choices, tolerance);
  std::vector<double> before;
  std::vector<double> scores;
  std::vector<double> covered_before;
  std::vector<double> covered_after;
  const std::vector<double> after = left_by(drives);
  for (std::size_t k = 0; k < drives.size(); ++k) {
    const HeldOut& drive = drives[k];
    before.push_back(drive.error_rad);
    const double z2_before = before[k] * before[k] / drive.before_rad2;
    const double z2_after = after[k] * after[k] / drive.after_rad2;
    scores.push_back(0.5 * (std::log(drive.before_rad2 / drive.after_rad2) + z2_before - z2_after));
    constexpr double kLimit = statistics::kHalfWidth95 * statistics::kHalfWidth95;
    covered_before.push_back(z2_before <= kLimit ? 1.0 : 0.0);
    covered_after.push_back(z2_after <= kLimit ? 1.0 : 0.0);
  }
  const auto rms_deg = [](const std::vector<double>& values) {
    return drawn(values.size(), [&](const std::vector<std::size_t>& indices) {
      return rms(values, indices) * units::kDegPerRad;
    });
  };
  return {
      .fitted = record.size() == drives.size() ? record.size() - 1 : record.size() - drives.size(),
      .held_out = drives.size(),
      .rms_before_deg = rms_deg(before),
      .rms_after_deg = rms_deg(after),
      .rms_ratio = ratio_of(after, before),
      .log_score_nats_per_drive = mean_of(scores),
      .coverage95_before = mean_of(covered_before),
      .coverage95_after = mean_of(covered_after)};
}

BootstrapFigure drift_ratio_of(const DriveRecord& record, const std::vector<MotionChoice>& choices,
                               std::size_t cause) {
  return ratio_of(left_by(hold_out(record, choices, 0.0)),
                  left_by(hold_out(record, without(choices, cause), 0.0)));
}

}  // namespace zerorate::diagnose
