#include "host_tools/lib/odometry/odometer_figures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::odometry {
namespace {

Situation situation_of(std::size_t row, std::optional<std::size_t> first_standing,
                       std::size_t last_standing) {
  if (!first_standing) return Situation::passing;
  if (row < *first_standing) return Situation::before_stop;
  return row > last_standing ? Situation::after_stop : Situation::inching;
}

Silence describe(const SpeedRecord& record, const Stretch& rows) {
  std::optional<std::size_t> first_standing;
  std::size_t last_standing = rows.begin;
  for (std::size_t row = rows.begin; row < rows.end; ++row) {
    if (!record.stands(row)) continue;
    if (!first_standing) first_standing = row;
    last_standing = row;
  }
  Silence silence{.rows = rows, .rolling = {}};
  for (std::size_t row = rows.begin; row < rows.end; ++row) {
    if (record.stands(row)) continue;
    silence.rolling.push_back({row, situation_of(row, first_standing, last_standing)});
  }
  return silence;
}

bool is_of(const RollingRow& rolling, std::optional<Situation> situation) {
  return !situation || rolling.situation == *situation;
}

}  // namespace

std::string_view name(Situation situation) {
  switch (situation) {
    case Situation::before_stop:
      return "before_stop";
    case Situation::after_stop:
      return "after_stop";
    case Situation::inching:
      return "inching";
    case Situation::passing:
      return "passing";
  }
  return "unknown";
}

std::vector<Silence> find_silences(const SpeedRecord& record) {
  std::vector<Silence> silences;
  for (const Stretch& rows :
       stretches(record, [&](std::size_t row) { return record.is_silent(row); })) {
    silences.push_back(describe(record, rows));
  }
  return silences;
}

Rolling describe_rolling(const SpeedRecord& record, const std::vector<Silence>& silences,
                         std::optional<Situation> situation) {
  Rolling described;
  std::vector<double> rolls(silences.size(), 0.0);
  for (std::size_t i = 0; i < silences.size(); ++i) {
    for (const RollingRow& rolling : silences[i].rolling) {
      if (!is_of(rolling, situation)) continue;
      rolls[i] += 1.0;
      described.speeds_m_s.push_back(record.reference_m_s[rolling.row]);
      if (record.yaw_rad_s.empty()) continue;
      described.turning_rad_s.push_back(std::abs(record.yaw_rad_s[rolling.row]));
    }
  }
  described.rows = described.speeds_m_s.size();
  std::ranges::sort(described.speeds_m_s);
  std::ranges::sort(described.turning_rad_s);
  if (silences.empty()) return described;
  const auto share = [&](const std::vector<std::size_t>& indices) {
    double rolling = 0.0;
    double rows = 0.0;
    for (const std::size_t index : indices) {
      rolling += rolls[index];
      rows += static_cast<double>(silences[index].rows.size());
    }
    return rolling / rows;
  };
  described.share =
      statistics::bootstrap(silences.size(), share, random::RandomStream{1}.substream("rolling"));
  return described;
}

}  // namespace zerorate::odometry
