#include "host_tools/lib/diagnose/drive/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "host_tools/lib/truth/delayed.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::seconds;

/// The bias drifts within a longer stop.
constexpr double kLongestPart_s = 30.0;
/// A shorter part of a stop measures nothing worth its cost.
constexpr double kShortestPart_s = 2.0;
/// Windows are no shorter, so that turns fit into them.
constexpr double kShortestWindow_s = 15.0;
/// A moment is straight where the heading changes by less within the time on both sides of it.
constexpr double kStraight_rad = 1.0 * units::kRadPerDeg;
constexpr double kBesideCut_s = 1.5;
/// Fewer windows, or fewer than drives, do not show a scatter of their own.
constexpr std::size_t kFewestWindows = 24;

std::int64_t nanoseconds(double time_s) {
  return static_cast<std::int64_t>(std::llround(time_s * 1e9));
}

/// Integral of the reference's speed [m]. An interval counts where it ends.
double metres_between(const truth::Series& speed_m_s, std::int64_t from_ns, std::int64_t to_ns) {
  double metres = 0.0;
  for (std::size_t k = std::max<std::size_t>(1, speed_m_s.first_from(from_ns + 1));
       k < speed_m_s.size() && speed_m_s.time_ns(k) <= to_ns; ++k) {
    metres += speed_m_s.value(k) * seconds(speed_m_s.time_ns(k) - speed_m_s.time_ns(k - 1));
  }
  return metres;
}

/// Makes drives of all their windows, and leaves those windows that tell more than their drive.
/// @param covariance of the errors of all windows
void make_rows(const Eigen::MatrixXd& covariance, DriveRecord& record) {
  std::vector<std::size_t> kept;
  record.drives.resize(record.number.size());
  for (std::size_t i = 0; i < record.windows.size(); ++i) {
    const Window& window = record.windows[i];
    DriveEvidence& drive = record.drives[window.drive];
    if (window.index == 0) drive.departure_s = window.sums.departure_s;
    drive.add(window.sums);
    const bool is_last =
        i + 1 == record.windows.size() || record.windows[i + 1].drive != window.drive;
    if (!is_last) kept.push_back(i);
  }
  if (kept.size() < std::max(kFewestWindows, record.size())) kept.clear();
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(
      static_cast<Eigen::Index>(record.size() + kept.size()), covariance.rows());
  for (std::size_t i = 0; i < record.windows.size(); ++i)
    sums(static_cast<Eigen::Index>(record.windows[i].drive), static_cast<Eigen::Index>(i)) = 1.0;
  std::vector<Window> windows;
  for (const std::size_t i : kept) {
    sums(static_cast<Eigen::Index>(record.size() + windows.size()), static_cast<Eigen::Index>(i)) =
        1.0;
    windows.push_back(record.windows[i]);
  }
  record.windows = std::move(windows);
  record.bias_rad2 = sums * covariance * sums.transpose();
}

/// Whether a drive makes no evidence.
bool is_spoilt(truth::Flaw flaw, std::size_t number, const std::vector<TraceFinding>& findings) {
  return flaw != truth::Flaw::none ||
         std::ranges::any_of(findings, [&](const TraceFinding& finding) {
           return std::ranges::find(finding.drives, number) != finding.drives.end();
         });
}

/// The truth with the delay that was found taken off, or as it is.
truth::Truth without_found_delay(truth::Truth truth, const truth::Track& track,
                                 const std::vector<TraceFinding>& findings) {
  for (const TraceFinding& finding : findings) {
    if (finding.delay_s == 0.0) continue;
    return truth::without_delay(std::move(truth), track, nanoseconds(finding.delay_s));
  }
  return truth;
}

}  // namespace

EvidenceCollector::EvidenceCollector(const truth::Track& track, const truth::Truth& truth)
    : track_(track), truth_(truth), longest_speed_ns_(track.speed_m_s.longest_interval_ns()) {
  for (const truth::Drive& drive : truth.drives) {
    Way way{.cuts_ns = cuts_of(drive), .windows = {}};
    way.windows.resize(way.cuts_ns.size() + 1);
    ways_.push_back(std::move(way));
  }
}

std::vector<std::int64_t> EvidenceCollector::cuts_of(const truth::Drive& drive) const {
  const std::int64_t longest_ns = truth_.heading_rad.longest_interval_ns();
  const std::int64_t beside_ns = nanoseconds(kBesideCut_s);
  const std::int64_t shortest_ns = nanoseconds(kShortestWindow_s);
  std::vector<std::int64_t> cuts;
  std::int64_t at_ns = drive.departure_ns + shortest_ns;
  while (at_ns + shortest_ns < drive.arrival_ns) {
    const auto before = truth_.heading_rad.at(at_ns - beside_ns, longest_ns);
    const auto after = truth_.heading_rad.at(at_ns + beside_ns, longest_ns);
    const bool is_straight = before && after && std::abs(*after - *before) < kStraight_rad;
    if (is_straight) cuts.push_back(at_ns);
    at_ns += is_straight ? shortest_ns : beside_ns;
  }
  return cuts;
}

void EvidenceCollector::add_to_way(const evaluate::ReplayedSample& sample, double elapsed_s,
                                   DriveEvidence& way) const {
  const app::RateMessage& message = sample.message;
  const double speed_m_s = track_.speed_m_s.at(sample.time_ns, longest_speed_ns_).value_or(0.0);
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
  const double turn_rad_s =
      truth_.vertical.sign *
      double{message.axes[truth_.vertical.axis].corrected.in(core::rad_per_s)};
  const double aside_g = speed_m_s * turn_rad_s / units::kGravity_m_s2;
  way.path_rad += std::abs(turn_rad_s) * elapsed_s;
  way.leant_rad_g2 += turn_rad_s * aside_g * aside_g * elapsed_s;
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
  Stretch& stretch =
      is_rest ? part_of_stop(time_s, elapsed_s) : window_at(sample.time_ns, ways_[next_]);
  if (!(stretch.span.length_s() > 0.0)) stretch.span.from_s = time_s - elapsed_s;
  stretch.span.to_s = time_s;
  add_to_way(sample, elapsed_s, stretch.sums);
}

EvidenceCollector::Stretch& EvidenceCollector::window_at(std::int64_t time_ns, Way& way) {
  while (way.newest < way.cuts_ns.size() && time_ns > way.cuts_ns[way.newest]) ++way.newest;
  return way.windows[way.newest];
}

EvidenceCollector::Stretch& EvidenceCollector::part_of_stop(double time_s, double elapsed_s) {
  const bool is_new_stop = rests_.empty() || stop_of_newest_rest_ != next_;
  if (is_new_stop || rests_.back().span.length_s() >= kLongestPart_s) {
    stop_of_newest_rest_ = next_;
    rests_.push_back({.span = {time_s - elapsed_s, time_s}, .sums = {}});
  }
  return rests_.back();
}

std::vector<double> EvidenceCollector::turns_of(const truth::Drive& drive,
                                                const std::vector<std::int64_t>& cuts_ns) const {
  const std::int64_t longest_ns = truth_.heading_rad.longest_interval_ns();
  const auto first_rad = truth_.heading_rad.at(drive.way_from_ns(), longest_ns);
  if (!first_rad) return {};
  std::vector<double> turns;
  double turned_rad = 0.0;
  for (const std::int64_t cut_ns : cuts_ns) {
    const auto heading_rad = truth_.heading_rad.at(cut_ns, longest_ns);
    if (!heading_rad) return {};
    turns.push_back(*heading_rad - *first_rad - turned_rad);
    turned_rad = *heading_rad - *first_rad;
  }
  turns.push_back(drive.way_turn_rad - turned_rad);
  return turns;
}

std::vector<EvidenceCollector::Stretch> EvidenceCollector::windows_of(const truth::Drive& drive,
                                                                      const Way& way) const {
  std::vector<Stretch> windows = way.windows;
  std::vector<double> turns = turns_of(drive, way.cuts_ns);
  std::vector<std::int64_t> ends_ns = way.cuts_ns;
  std::erase_if(windows, [](const Stretch& window) { return !(window.span.length_s() > 0.0); });
  if (windows.empty()) return {};
  if (windows.size() < way.windows.size() || turns.empty()) {
    for (std::size_t i = 1; i < windows.size(); ++i) windows[0].sums.add(windows[i].sums);
    windows[0].span.to_s = windows.back().span.to_s;
    windows.resize(1);
    turns = {drive.way_turn_rad};
    ends_ns.clear();
  }
  ends_ns.push_back(drive.arrival_ns);
  std::int64_t from_ns = drive.departure_ns;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    windows[i].sums.departure_s = seconds(from_ns);
    windows[i].sums.metres = metres_between(track_.speed_m_s, from_ns, ends_ns[i]);
    windows[i].sums.turn_rad = turns[i];
    from_ns = ends_ns[i];
  }
  return windows;
}

DriveRecord EvidenceCollector::finish(const evaluate::TrueDrives& drives,
                                      const BiasProcess& process,
                                      std::vector<TraceFinding> findings) const {
  DriveRecord record{.vertical = truth_.vertical,
                     .axis_count = track_.axis_count,
                     .has_acceleration = has_acceleration_,
                     .has_headings_at_stops_only = truth_.has_headings_at_stops_only,
                     .reference_sigma_rad = truth_.reference_error_rad / std::numbers::sqrt2,
                     .findings = std::move(findings),
                     .obstacle = truth_.obstacle};
  std::vector<Stretch> windows;
  for (std::size_t k = 0; k < drives.drives.size(); ++k) {
    const evaluate::ScoredTrueDrive& scored = drives.drives[k];
    const std::vector<Stretch> own = windows_of(scored.drive, ways_[k]);
    if (own.empty() || is_spoilt(scored.flaw, k, record.findings)) {
      ++record.left_out;
      continue;
    }
    for (std::size_t i = 0; i < own.size(); ++i) {
      record.windows.push_back({.drive = record.number.size(), .index = i, .sums = {}});
      windows.push_back(own[i]);
    }
    record.number.push_back(k);
  }
  std::vector<Stretch> rests = rests_;
  std::erase_if(rests, [](const Stretch& rest) { return rest.span.length_s() < kShortestPart_s; });
  if (rests.empty() && record.obstacle.empty()) record.obstacle = "no stop has a sample";
  if (!record.obstacle.empty()) return record;
  const Eigen::MatrixXd covariance = take_rest_off(process, rests, windows);
  for (std::size_t i = 0; i < windows.size(); ++i) record.windows[i].sums = windows[i].sums;
  make_rows(covariance, record);
  return record;
}

Eigen::MatrixXd EvidenceCollector::take_rest_off(const BiasProcess& process,
                                                 const std::vector<Stretch>& rests,
                                                 std::vector<Stretch>& windows) const {
  std::vector<Span> at_rest;
  std::vector<Span> on_the_way;
  at_rest.reserve(rests.size());
  on_the_way.reserve(windows.size());
  for (const Stretch& rest : rests) at_rest.push_back(rest.span);
  for (const Stretch& window : windows) on_the_way.push_back(window.span);
  const BiasForecast forecast = forecast_bias(process, at_rest, on_the_way);
  for (std::size_t i = 0; i < windows.size(); ++i) {
    DriveEvidence& one = windows[i].sums;
    for (std::size_t k = 0; k < rests.size(); ++k) {
      const DriveEvidence& rest = rests[k].sums;
      const double weight =
          forecast.weights(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        one.turned_rad[axis] -= weight * rest.turned_rad[axis];
        one.force_g_s[axis] -= weight * rest.force_g_s[axis];
      }
      one.vibration_g2_s -= weight * rest.vibration_g2_s;
    }
    one.error_rad = truth_.vertical.sign * one.turned_rad[truth_.vertical.axis] - one.turn_rad +
                    one.missed_rad();
  }
  return forecast.covariance;
}

DriveRecord read_drive_record(const recording::Input& input, const truth::Track& track,
                              const truth::Truth& given, model::SensorModel model) {
  if (!given.obstacle.empty()) return {.obstacle = given.obstacle};
  if (!model.scale_factor) model.scale_factor.emplace();
  model.scale_factor->sigma = 0.0;
  model.scale_factor->asymmetry_sigma = 0.0;
  model.scale_factor->sigma_per_k = 0.0;
  model.mounting.reset();
  const BiasProcess process{model};
  std::vector<TraceFinding> findings = find_in_trace(read_trace(input, given));
  const truth::Truth truth = without_found_delay(given, track, findings);
  EvidenceCollector collector{track, truth};
  recording::Reader reader{input};
  const auto result = evaluate::replay(
      reader, {.model = std::move(model)},
      {.truth = truth,
       .on_sample = [&](const evaluate::ReplayedSample& sample) { collector.take(sample); }});
  return collector.finish(*result.true_drives, process, std::move(findings));
}

}  // namespace zerorate::diagnose
