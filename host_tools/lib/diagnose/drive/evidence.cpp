#include "host_tools/lib/diagnose/drive/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::seconds;

/// The bias drifts within a longer stop.
constexpr double kLongestPart_s = 30.0;
/// A shorter part of a stop measures nothing worth its cost.
constexpr double kShortestPart_s = 2.0;
/// Share of every turn that an axis misses on grades and by the lean in curves, and its standard
/// deviation: 0.045 % on a grade of 3 %, 0.03 % in a curve of 0.3 g, never less than none. The mean
/// is that of a lean of 5 deg per g in curves of 0.2 g, and of grades of 1.5 %.
constexpr double kMissedShare = 2.5e-4;
constexpr double kMissedSigma = 3e-4;

/// Integral of the reference's speed [m].
double metres_between(const truth::Series& speed_m_s, std::int64_t from_ns, std::int64_t to_ns) {
  double metres = 0.0;
  for (std::size_t k = speed_m_s.first_from(from_ns) + 1;
       k < speed_m_s.size() && speed_m_s.time_ns(k) <= to_ns; ++k) {
    metres += speed_m_s.value(k) * seconds(speed_m_s.time_ns(k) - speed_m_s.time_ns(k - 1));
  }
  return metres;
}

/// Whether a drive makes no evidence. A late reference parts from the gyro in fast turns as one
/// that jumps does, and catches up at rest: its jumps are those of the trace, without the delay.
bool is_spoilt(truth::Flaw flaw, std::size_t number, const std::vector<TraceFinding>& findings) {
  bool is_late = false;
  for (const TraceFinding& finding : findings) {
    if (std::ranges::find(finding.drives, number) != finding.drives.end()) return true;
    is_late |= finding.catches_up;
  }
  return flaw != truth::Flaw::none && !(is_late && flaw == truth::Flaw::heading_jump);
}

}  // namespace

Eigen::VectorXd DriveRecord::errors() const {
  Eigen::VectorXd errors(static_cast<Eigen::Index>(size()));
  for (std::size_t i = 0; i < size(); ++i)
    errors[static_cast<Eigen::Index>(i)] = drives[i].error_rad;
  return errors;
}

Eigen::MatrixXd DriveRecord::covariance() const {
  Eigen::MatrixXd v = bias_rad2;
  const double reference_rad2 = reference_sigma_rad * reference_sigma_rad;
  for (std::size_t i = 0; i < size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    v(k, k) += 2.0 * reference_rad2 + way_sigma_rad * way_sigma_rad;
    for (std::size_t j = 0; j < size(); ++j) {
      v(k, static_cast<Eigen::Index>(j)) +=
          kMissedSigma * kMissedSigma * drives[i].turn_rad * drives[j].turn_rad;
    }
    if (i + 1 == size() || number[i + 1] != number[i] + 1) continue;
    v(k, k + 1) -= reference_rad2;
    v(k + 1, k) -= reference_rad2;
  }
  return v;
}

EvidenceCollector::EvidenceCollector(const truth::Track& track, const truth::Truth& truth)
    : track_(track), truth_(truth), ways_(truth.drives.size()) {}

void EvidenceCollector::add_to_way(const evaluate::ReplayedSample& sample, double elapsed_s,
                                   DriveEvidence& way) const {
  const app::RateMessage& message = sample.message;
  for (std::size_t i = 0; i < 3; ++i) {
    // With the bias, which is taken off when all stops are over.
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
  const double time_s = seconds(sample.time_ns);
  const bool is_after = next_ == ways_.size();
  const bool is_rest = is_after || sample.time_ns <= truth_.drives[next_].way_from_ns();
  Stretch& stretch = is_rest ? part_of_stop(time_s, elapsed_s) : ways_[next_];
  if (!(stretch.span.length_s() > 0.0)) stretch.span.from_s = time_s - elapsed_s;
  stretch.span.to_s = time_s;
  add_to_way(sample, elapsed_s, stretch.sums);
}

EvidenceCollector::Stretch& EvidenceCollector::part_of_stop(double time_s, double elapsed_s) {
  const bool is_new_stop = rests_.empty() || stop_of_newest_rest_ != next_;
  if (is_new_stop || rests_.back().span.length_s() >= kLongestPart_s) {
    stop_of_newest_rest_ = next_;
    rests_.push_back({.span = {time_s - elapsed_s, time_s}, .sums = {}});
  }
  return rests_.back();
}

DriveRecord EvidenceCollector::finish(const evaluate::TrueDrives& drives,
                                      const BiasProcess& process,
                                      std::vector<TraceFinding> findings) const {
  DriveRecord record{.vertical = truth_.vertical,
                     .axis_count = track_.axis_count,
                     .has_acceleration = has_acceleration_,
                     .reference_sigma_rad = truth_.reference_error_rad / std::numbers::sqrt2,
                     .findings = std::move(findings),
                     .obstacle = truth_.obstacle};
  std::vector<Span> spans;
  for (std::size_t k = 0; k < drives.drives.size(); ++k) {
    const evaluate::ScoredTrueDrive& scored = drives.drives[k];
    if (is_spoilt(scored.flaw, k, record.findings) || !(ways_[k].span.length_s() > 0.0)) {
      ++record.left_out;
      continue;
    }
    DriveEvidence one = ways_[k].sums;
    one.departure_s = seconds(scored.drive.departure_ns);
    one.metres =
        metres_between(track_.speed_m_s, scored.drive.departure_ns, scored.drive.arrival_ns);
    one.turn_rad = scored.drive.way_turn_rad;
    record.drives.push_back(one);
    record.number.push_back(k);
    spans.push_back(ways_[k].span);
  }
  take_rest_off(process, spans, record);
  return record;
}

void EvidenceCollector::take_rest_off(const BiasProcess& process, const std::vector<Span>& drives,
                                      DriveRecord& record) const {
  std::vector<Span> spans;
  std::vector<const DriveEvidence*> at_rest;
  for (const Stretch& rest : rests_) {
    if (rest.span.length_s() < kShortestPart_s) continue;
    spans.push_back(rest.span);
    at_rest.push_back(&rest.sums);
  }
  if (spans.empty() && record.obstacle.empty()) record.obstacle = "no stop has a sample";
  if (!record.obstacle.empty()) return;
  const BiasForecast forecast = forecast_bias(process, spans, drives);
  record.bias_rad2 = forecast.covariance;
  for (std::size_t i = 0; i < record.size(); ++i) {
    DriveEvidence& one = record.drives[i];
    for (std::size_t k = 0; k < at_rest.size(); ++k) {
      const double weight =
          forecast.weights(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        one.turned_rad[axis] -= weight * at_rest[k]->turned_rad[axis];
        one.force_g_s[axis] -= weight * at_rest[k]->force_g_s[axis];
      }
      one.vibration_g2_s -= weight * at_rest[k]->vibration_g2_s;
    }
    one.error_rad = truth_.vertical.sign * one.turned_rad[truth_.vertical.axis] -
                    (1.0 - kMissedShare) * one.turn_rad;
  }
}

DriveRecord read_drive_record(const recording::Input& input, const truth::Track& track,
                              const truth::Truth& truth, model::SensorModel model) {
  if (!truth.obstacle.empty()) return {.obstacle = truth.obstacle};
  if (!model.scale_factor) model.scale_factor.emplace();
  model.scale_factor->sigma = 0.0;
  model.scale_factor->asymmetry_sigma = 0.0;
  model.mounting.reset();
  const BiasProcess process{model};
  EvidenceCollector collector{track, truth};
  recording::Reader reader{input};
  const auto result = evaluate::replay(
      reader, {.model = std::move(model)},
      {.truth = truth,
       .on_sample = [&](const evaluate::ReplayedSample& sample) { collector.take(sample); }});
  return collector.finish(*result.true_drives, process, find_in_trace(read_trace(input, truth)));
}

}  // namespace zerorate::diagnose
