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

TrueScore TrueDrives::score(app::Predictor predictor, Scored scored_as) const {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> sizes;
  double squares = 0.0;
  double sigmas = 0.0;
  double covered = 0.0;
  double covered_by_node = 0.0;
  for (const ScoredTrueDrive& scored : drives) {
    if (scored.flaw != truth::Flaw::none) continue;
    const DriveOutcome& outcome = scored.outcome(predictor, scored_as);
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

void WayIntegral::add(std::int64_t begin_ns, std::int64_t end_ns, double rate_rad_s, bool moves) {
  const std::int64_t overlap_ns = std::min(end_ns, to_ns_) - std::max(begin_ns, from_ns_);
  if (overlap_ns <= 0) return;
  const double elapsed_s = seconds(overlap_ns);
  turned_rad_ += rate_rad_s * elapsed_s;
  path_rad_ += std::abs(rate_rad_s) * elapsed_s;
  moved_s_ += moves ? elapsed_s : 0.0;
  squared_intervals_s2_ += elapsed_s * elapsed_s;
}

double WayIntegral::length_s() const {
  return seconds(to_ns_ - from_ns_);
}

void TrueDriveScorer::open() {
  const truth::Drive& drive = result_.drives[next_].drive;
  is_open_ = true;
  has_departed_ = false;
  measured_ = {drive.from_ns, drive.to_ns};
  ways_.fill({drive.way_from_ns(), drive.way_to_ns()});
  motion_.reset();
}

/// The rate of a sample stands for the time since the one before, as far as it lies in the drive.
void TrueDriveScorer::integrate(ScoredTrueDrive& scored, std::int64_t time_ns,
                                double measured_rad_s, double published_rad_s, bool moves) {
  const std::int64_t begin_ns = has_sample_ ? newest_ns_ : time_ns;
  if (!has_sample_ && time_ns > scored.drive.from_ns) scored.flaw = truth::Flaw::rate_missing;
  if (time_ns - begin_ns > longest_ns_) scored.flaw = truth::Flaw::rate_missing;
  measured_.add(begin_ns, time_ns, measured_rad_s, moves);
  for (std::size_t p = 0; p < app::kPredictors; ++p) {
    const bool is_published = static_cast<app::Predictor>(p) == result_.published;
    ways_[p].add(begin_ns, time_ns, is_published ? published_rad_s : measured_rad_s - biases_[p],
                 moves);
  }
  add_points(scored, time_ns);
}

void TrueDriveScorer::add_points(ScoredTrueDrive& scored, std::int64_t time_ns) const {
  const truth::Drive& drive = scored.drive;
  if (time_ns < drive.way_from_ns()) return;
  const double now_s = seconds(std::min(time_ns, drive.way_to_ns()));
  const double before_s = scored.along.empty() ? -1.0 : scored.along.back().time_s;
  const bool is_end = time_ns >= drive.way_to_ns() && now_s > before_s;
  if (!scored.along.empty() && now_s - before_s < 1.0 && !is_end) return;
  scored.along.push_back({now_s, ways_[static_cast<std::size_t>(result_.published)].turned_rad()});
}

double TrueDriveScorer::variance(const WayIntegral& way, double turn_rad) const {
  const core::HeadingFilter::Turn turn{static_cast<float>(turn_rad),
                                       static_cast<float>(way.moved_s())};
  const double of_asymmetry = asymmetry_ * way.path_rad();
  return white_variance_rad2_s2_ * way.squared_intervals_s2() +
         (motion_ ? double{motion_->turn_variance_rad2(turn)} : 0.0) + of_asymmetry * of_asymmetry;
}

DriveOutcome TrueDriveScorer::outcome(const WayIntegral& way, double turned_rad,
                                      double variance_rad2, double true_turn_rad) const {
  double turn_rad = result_.truth.vertical.sign * turned_rad;
  const double unscaled_rad =
      turn_rad - (motion_ ? double{motion_->offset_rad_s()} * way.moved_s() : 0.0);
  if (motion_) turn_rad = double{motion_->scaled(static_cast<float>(unscaled_rad))};
  return {.drift_rad = turn_rad - true_turn_rad,
          .sigma_rad = std::sqrt(variance_rad2 + variance(way, unscaled_rad)),
          .rsse_rad_s = std::numeric_limits<double>::quiet_NaN()};
}

/// Turns the integrals along the drive into errors.
void TrueDriveScorer::close(ScoredTrueDrive& scored) {
  const truth::Drive& drive = scored.drive;
  const truth::Truth& truth = result_.truth;
  for (std::size_t p = 0; p < app::kPredictors; ++p) {
    const double turned_rad = measured_.turned_rad() - at_departure_[p] * measured_.length_s();
    scored.at_departure[p] = outcome(measured_, turned_rad, variances_[p], drive.turn_rad);
    const WayIntegral& way = ways_[p];
    scored.outcomes[p] = outcome(way, way.turned_rad(), way_variances_[p], drive.way_turn_rad);
    if (static_cast<app::Predictor>(p) != result_.published) continue;
    // Scale factor and offset are taken off already, as the node learnt them on the way.
    scored.outcomes[p].drift_rad = truth.vertical.sign * way.turned_rad() - drive.way_turn_rad;
  }
  const std::int64_t longest_ns = truth.heading_rad.longest_interval_ns();
  const auto start = truth.heading_rad.at(drive.way_from_ns(), longest_ns);
  std::vector<ScoredTrueDrive::Point> along;
  for (const ScoredTrueDrive::Point& point : scored.along) {
    const auto time_ns = static_cast<std::int64_t>(std::llround(point.time_s * 1e9));
    const auto heading = truth.heading_rad.at(time_ns, longest_ns);
    if (scored.flaw != truth::Flaw::none || !start || !heading) continue;
    along.push_back({point.time_s, truth.vertical.sign * point.error_rad - (*heading - *start)});
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
