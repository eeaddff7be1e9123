#include "host_tools/lib/evaluate/true_drives.hpp"

#include <limits>
#include <utility>

#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::evaluate {
using units::seconds;

std::size_t TrueDrives::scored() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      drives, [](const ScoredTrueDrive& scored) { return scored.flaw == truth::Flaw::none; }));
}

TrueScore TrueDrives::score(app::Predictor predictor) const {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> sizes;
  double squares = 0.0;
  double sigmas = 0.0;
  double covered = 0.0;
  double covered_by_node = 0.0;
  for (const ScoredTrueDrive& scored : drives) {
    if (scored.flaw != truth::Flaw::none) continue;
    const DriveOutcome& outcome = scored.outcomes[static_cast<std::size_t>(predictor)];
    const double size = std::abs(outcome.drift_rad);
    const double sigma = std::hypot(outcome.sigma_rad, truth.reference_error_rad);
    sizes.push_back(size);
    squares += size * size;
    sigmas += sigma;
    covered += size <= statistics::kHalfWidth95 * sigma ? 1.0 : 0.0;
    covered_by_node += size <= statistics::kHalfWidth95 * outcome.sigma_rad ? 1.0 : 0.0;
  }
  if (sizes.empty()) {
    return {0, kUnknown, kUnknown, kUnknown, kUnknown, kUnknown, kUnknown};
  }
  std::ranges::sort(sizes);
  const auto count = static_cast<double>(sizes.size());
  const double rms = std::sqrt(squares / count);
  return {.drives = sizes.size(),
          .rms_rad = rms,
          .median_rad = statistics::quantile_of_sorted(sizes, 0.5),
          .worst_rad = sizes.back(),
          .coverage95 = covered / count,
          .coverage95_of_node = covered_by_node / count,
          .sigma_over_rms = sigmas / count / rms};
}

TrueDriveScorer::TrueDriveScorer(truth::Truth truth, core::Duration shift,
                                 core::Duration longest_interval, app::Predictor published)
    : shift_(shift), longest_ns_(longest_interval.ns()) {
  result_.truth = std::move(truth);
  result_.published = published;
  for (const truth::Drive& drive : result_.truth.drives) {
    result_.drives.push_back({.drive = drive, .flaw = drive.flaw});
  }
}

void TrueDriveScorer::open() {
  is_open_ = true;
  has_departed_ = false;
  turned_rad_ = 0.0;
  path_rad_ = 0.0;
  moved_s_ = 0.0;
  motion_.reset();
  squared_intervals_s2_ = 0.0;
}

/// The rate of a sample stands for the time since the one before, as far as it lies in the drive.
void TrueDriveScorer::integrate(ScoredTrueDrive& scored, std::int64_t time_ns, double rate_rad_s,
                                bool moves) {
  const truth::Drive& drive = scored.drive;
  const std::int64_t begin_ns = has_sample_ ? newest_ns_ : time_ns;
  const std::int64_t overlap_ns =
      std::min(time_ns, drive.to_ns) - std::max(begin_ns, drive.from_ns);
  if (!has_sample_ && time_ns > drive.from_ns) scored.flaw = truth::Flaw::rate_missing;
  if (time_ns - begin_ns > longest_ns_) scored.flaw = truth::Flaw::rate_missing;
  const double elapsed_s = seconds(overlap_ns);
  turned_rad_ += rate_rad_s * elapsed_s;
  path_rad_ += std::abs(rate_rad_s) * elapsed_s;
  moved_s_ += moves ? elapsed_s : 0.0;
  squared_intervals_s2_ += elapsed_s * elapsed_s;
  const double now_s = seconds(std::min(time_ns, drive.to_ns));
  if (scored.along.empty() || now_s - scored.along.back().time_s >= 1.0 || time_ns >= drive.to_ns) {
    scored.along.push_back({now_s, turned_rad_});
  }
}

DriveOutcome TrueDriveScorer::outcome(double corrected_rad, double variance_rad2,
                                      double true_turn_rad) const {
  DriveOutcome result{.drift_rad = corrected_rad - true_turn_rad,
                      .sigma_rad = std::sqrt(variance_rad2),
                      .rsse_rad_s = std::numeric_limits<double>::quiet_NaN()};
  if (!motion_) return result;
  const double turn_rad = corrected_rad - double{motion_->offset_rad_s()} * moved_s_;
  const core::HeadingFilter::Turn turn{static_cast<float>(turn_rad), static_cast<float>(moved_s_)};
  result.drift_rad = double{motion_->scaled(turn.turn_rad)} - true_turn_rad;
  const double of_asymmetry = asymmetry_ * path_rad_;
  result.sigma_rad = std::sqrt(variance_rad2 + double{motion_->turn_variance_rad2(turn)} +
                               of_asymmetry * of_asymmetry);
  return result;
}

/// Turns the integral along the drive into the error, for which the bias at departure is known now.
void TrueDriveScorer::close(ScoredTrueDrive& scored) {
  const truth::Drive& drive = scored.drive;
  const truth::Truth& truth = result_.truth;
  const double from_s = seconds(drive.from_ns);
  const double length_s = seconds(drive.to_ns - drive.from_ns);
  for (std::size_t p = 0; p < app::kPredictors; ++p) {
    const double corrected_rad = turned_rad_ - biases_[p] * length_s;
    scored.outcomes[p] =
        outcome(truth.vertical.sign * corrected_rad,
                variances_[p] + white_variance_rad2_s2_ * squared_intervals_s2_, drive.turn_rad);
  }
  const std::int64_t longest_ns = truth.heading_rad.longest_interval_ns();
  const auto start = truth.heading_rad.at(drive.from_ns, longest_ns);
  std::vector<ScoredTrueDrive::Point> along;
  for (const ScoredTrueDrive::Point& point : scored.along) {
    const auto time_ns = static_cast<std::int64_t>(std::llround(point.time_s * 1e9));
    const auto heading = truth.heading_rad.at(time_ns, longest_ns);
    if (scored.flaw != truth::Flaw::none || !start || !heading) continue;
    const double corrected_rad =
        point.error_rad -
        biases_[static_cast<std::size_t>(result_.published)] * (point.time_s - from_s);
    along.push_back({point.time_s, truth.vertical.sign * corrected_rad - (*heading - *start)});
  }
  scored.along = std::move(along);
  is_open_ = false;
  ++next_;
}

TrueDrives TrueDriveScorer::finish() {
  for (; next_ < result_.drives.size(); ++next_) {
    result_.drives[next_].flaw = truth::Flaw::rate_missing;
    result_.drives[next_].along.clear();
  }
  return std::move(result_);
}

}  // namespace zerorate::evaluate
