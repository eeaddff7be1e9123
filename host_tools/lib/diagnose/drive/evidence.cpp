#include "host_tools/lib/diagnose/drive/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::seconds;

/// Variance of a bias between two stops over that after one, in the drives of
/// diagnosed_drives_test.
constexpr double kBetweenStops = 0.5;

/// In a longer stop the bias has drifted from that of the drive before it.
constexpr double kFirst_s = 30.0;

/// Integral of the reference's speed [m].
double metres_between(const truth::Series& speed_m_s, std::int64_t from_ns, std::int64_t to_ns) {
  double metres = 0.0;
  for (std::size_t k = speed_m_s.first_from(from_ns) + 1;
       k < speed_m_s.size() && speed_m_s.time_ns(k) <= to_ns; ++k) {
    metres += speed_m_s.value(k) * seconds(speed_m_s.time_ns(k) - speed_m_s.time_ns(k - 1));
  }
  return metres;
}

}  // namespace

Eigen::VectorXd DriveRecord::errors() const {
  Eigen::VectorXd errors(static_cast<Eigen::Index>(size()));
  for (std::size_t i = 0; i < size(); ++i)
    errors[static_cast<Eigen::Index>(i)] = drives[i].error_rad;
  return errors;
}

Eigen::MatrixXd DriveRecord::covariance() const {
  const auto count = static_cast<Eigen::Index>(size());
  Eigen::MatrixXd v = Eigen::MatrixXd::Zero(count, count);
  // The bias errs by its drift within a drive, which no neighbour shares.
  const double reference_rad2 = reference_sigma_rad * reference_sigma_rad;
  for (std::size_t i = 0; i < size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    v(k, k) = drives[i].variance_rad2 + 2.0 * reference_rad2;
    if (i + 1 == size() || number[i + 1] != number[i] + 1) continue;
    v(k, k + 1) = -reference_rad2;
    v(k + 1, k) = -reference_rad2;
  }
  return v;
}

EvidenceCollector::EvidenceCollector(const truth::Track& track, const truth::Truth& truth)
    : track_(track), truth_(truth), ways_(truth.drives.size()), rests_(truth.drives.size() + 1) {}

void EvidenceCollector::add_to_way(const evaluate::ReplayedSample& sample, double elapsed_s,
                                   DriveEvidence& way) const {
  const app::RateMessage& message = sample.message;
  for (std::size_t i = 0; i < 3; ++i) {
    // With the bias, which is taken off when both of its stops are over.
    const double rate_rad_s = double{message.axes[i].corrected.in(core::rad_per_s)} +
                              double{message.axes[i].bias.in(core::rad_per_s)};
    way.turned_rad[i] += rate_rad_s * elapsed_s;
    if (message.acceleration) {
      way.force_g_s[i] +=
          double{(*message.acceleration)[i].in(core::m_per_s2)} / units::kGravity_m_s2 * elapsed_s;
    }
  }
  way.length_s += elapsed_s;
  if (message.motion != core::Motion::still) way.moving_s += elapsed_s;
  way.path_rad +=
      std::abs(double{message.axes[truth_.vertical.axis].corrected.in(core::rad_per_s)}) *
      elapsed_s;
  if (message.vibration) {
    const double g = double{message.vibration->in(core::m_per_s2)} / units::kGravity_m_s2;
    way.vibration_g2_s += g * g * elapsed_s;
  }
}

void EvidenceCollector::take(const evaluate::ReplayedSample& sample) {
  if (!sample.message.has_rate()) return;
  const std::int64_t before_ns = newest_ns_.value_or(sample.time_ns);
  newest_ns_ = sample.time_ns;
  has_acceleration_ |= sample.message.acceleration.has_value();
  while (next_ < ways_.size() && sample.time_ns > truth_.drives[next_].way_to_ns()) ++next_;
  const double elapsed_s = seconds(sample.time_ns - before_ns);
  const bool is_after = next_ == ways_.size();
  const bool is_rest = is_after || sample.time_ns <= truth_.drives[next_].way_from_ns();
  if (!is_rest) return add_to_way(sample, elapsed_s, ways_[next_]);
  Rest& rest = rests_[next_];
  DriveEvidence sums;
  add_to_way(sample, elapsed_s, sums);
  const auto& axes = sample.message.axes;
  for (std::size_t i = 0; i < 3; ++i) {
    rest.bias_rad_s[i] = double{axes[i].bias.in(core::rad_per_s)};
    if (rest.length_s < kFirst_s) rest.first_bias_rad_s[i] = rest.bias_rad_s[i];
    rest.force_g_s[i] += sums.force_g_s[i];
  }
  rest.vibration_g2_s += sums.vibration_g2_s;
  rest.length_s += elapsed_s;
  rest.sigma_rad_s = double{axes[truth_.vertical.axis].sigma.in(core::rad_per_s)};
}

DriveRecord EvidenceCollector::finish(const evaluate::TrueDrives& drives) const {
  DriveRecord record{.vertical = truth_.vertical,
                     .axis_count = track_.axis_count,
                     .has_acceleration = has_acceleration_,
                     .reference_sigma_rad = truth_.reference_error_rad / std::numbers::sqrt2,
                     .obstacle = truth_.obstacle};
  for (std::size_t k = 0; k < drives.drives.size(); ++k) {
    const evaluate::ScoredTrueDrive& scored = drives.drives[k];
    const Rest& before = rests_[k];
    const Rest& after = rests_[k + 1];
    if (scored.flaw != truth::Flaw::none ||
        !std::isfinite(before.sigma_rad_s + after.sigma_rad_s)) {
      ++record.left_out;
      continue;
    }
    DriveEvidence one = ways_[k];
    one.departure_s = seconds(scored.drive.departure_ns);
    for (std::size_t i = 0; i < 3; ++i) {
      one.turned_rad[i] -= 0.5 * (before.bias_rad_s[i] + after.first_bias_rad_s[i]) * one.length_s;
      one.force_g_s[i] -= before.mean(before.force_g_s[i]) * one.length_s;
    }
    one.vibration_g2_s -= before.mean(before.vibration_g2_s) * one.length_s;
    one.metres =
        metres_between(track_.speed_m_s, scored.drive.departure_ns, scored.drive.arrival_ns);
    one.turn_rad = scored.drive.way_turn_rad;
    one.error_rad = truth_.vertical.sign * one.turned_rad[truth_.vertical.axis] - one.turn_rad;
    // After a stop the bias drifts; between two of them it errs by half as much.
    const auto& outcome = scored.outcome(drives.published, evaluate::Scored::published);
    one.variance_rad2 = kBetweenStops * outcome.sigma_rad * outcome.sigma_rad;
    record.drives.push_back(one);
    record.number.push_back(k);
  }
  return record;
}

DriveRecord read_drive_record(const recording::Input& input, const truth::Track& track,
                              const truth::Truth& truth, model::SensorModel model) {
  if (!truth.obstacle.empty()) return {.obstacle = truth.obstacle};
  if (!model.scale_factor) model.scale_factor.emplace();
  model.scale_factor->sigma = 0.0;
  model.scale_factor->asymmetry_sigma = 0.0;
  model.mounting.reset();
  EvidenceCollector collector{track, truth};
  recording::Reader reader{input};
  const auto result = evaluate::replay(
      reader, {.model = std::move(model)},
      {.truth = truth,
       .on_sample = [&](const evaluate::ReplayedSample& sample) { collector.take(sample); }});
  return collector.finish(*result.true_drives);
}

}  // namespace zerorate::diagnose
