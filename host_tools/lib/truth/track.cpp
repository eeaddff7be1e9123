#include "host_tools/lib/truth/track.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace zerorate::truth {
namespace {

constexpr double kSecondsPerNs = 1e-9;

/// Adds row after row to a track.
class TrackBuilder {
 public:
  TrackBuilder(const recording::Columns& columns, Track& track)
      : columns_(columns), track_(track) {}

  void take(const recording::Row& row) {
    if (started_ && row.time_ns <= newest_ns_) return;
    const double elapsed_s =
        started_ ? static_cast<double>(row.time_ns - newest_ns_) * kSecondsPerNs : 0.0;
    started_ = true;
    newest_ns_ = row.time_ns;
    turn(row, elapsed_s);
    if (columns_.ref_heading) {
      take_heading(row);
    } else if (columns_.ref_rate) {
      take_rate(row);
    }
    if (columns_.ref_speed && std::isfinite(row.ref_speed_m_s)) {
      track_.speed_m_s.add(row.time_ns, std::abs(double{row.ref_speed_m_s}));
    }
  }

 private:
  void turn(const recording::Row& row, double elapsed_s) {
    for (std::size_t axis = 0; axis < columns_.axis_count; ++axis) {
      if (std::isfinite(row.rate_rad_s[axis])) rate_rad_s_[axis] = double{row.rate_rad_s[axis]};
      turned_rad_[axis] += rate_rad_s_[axis] * elapsed_s;
    }
  }

  void take_heading(const recording::Row& row) {
    if (!std::isfinite(row.ref_heading_rad)) return;
    const double wrapped = double{row.ref_heading_rad};
    if (track_.heading_rad.size() == 0) {
      heading_rad_ = wrapped;
    } else {
      heading_rad_ += std::remainder(wrapped - heading_rad_, 2.0 * std::numbers::pi);
    }
    add_heading(row.time_ns);
  }

  /// The trapezoidal rule. A hole leaves a hole in the heading, too.
  void take_rate(const recording::Row& row) {
    if (!std::isfinite(row.ref_rate_rad_s)) return;
    const double rate = double{row.ref_rate_rad_s};
    if (const std::size_t size = track_.heading_rad.size(); size > 0) {
      const std::int64_t since_ns = row.time_ns - track_.heading_rad.time_ns(size - 1);
      heading_rad_ +=
          0.5 * (rate + latest_ref_rate_) * static_cast<double>(since_ns) * kSecondsPerNs;
    }
    latest_ref_rate_ = rate;
    add_heading(row.time_ns);
  }

  void add_heading(std::int64_t time_ns) {
    track_.heading_rad.add(time_ns, heading_rad_);
    track_.turned_rad.push_back(turned_rad_);
  }

  const recording::Columns& columns_;
  Track& track_;
  bool started_ = false;
  std::int64_t newest_ns_ = 0;
  double heading_rad_ = 0.0;
  double latest_ref_rate_ = 0.0;
  std::array<double, recording::kMaxAxes> rate_rad_s_{};
  std::array<double, recording::kMaxAxes> turned_rad_{};
};

}  // namespace

std::int64_t Series::longest_interval_ns() const {
  constexpr std::int64_t kAtLeast = 2'000'000'000;
  if (size() < 2) return kAtLeast;
  std::vector<std::int64_t> intervals;
  intervals.reserve(size() - 1);
  for (std::size_t k = 1; k < size(); ++k) intervals.push_back(time_ns_[k] - time_ns_[k - 1]);
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::ranges::nth_element(intervals, middle);
  return std::max(kAtLeast, 3 * *middle);
}

std::optional<double> Series::at(std::int64_t time_ns, std::int64_t longest_ns) const {
  const std::size_t k = first_from(time_ns);
  if (k == size()) return std::nullopt;
  if (time_ns_[k] == time_ns) return value_[k];
  if (k == 0 || time_ns_[k] - time_ns_[k - 1] > longest_ns) return std::nullopt;
  const double share = static_cast<double>(time_ns - time_ns_[k - 1]) /
                       static_cast<double>(time_ns_[k] - time_ns_[k - 1]);
  return value_[k - 1] + share * (value_[k] - value_[k - 1]);
}

bool Series::covers(std::int64_t from_ns, std::int64_t to_ns, std::int64_t longest_ns) const {
  if (size() == 0 || from_ns < time_ns_.front() || to_ns > time_ns_.back()) return false;
  const auto first = std::ranges::upper_bound(time_ns_, from_ns);
  for (auto k = first; k != time_ns_.end() && *(k - 1) < to_ns; ++k) {
    if (*k - *(k - 1) > longest_ns) return false;
  }
  return true;
}

Track read_track(recording::Reader& reader) {
  Track track{.axis_count = reader.columns().axis_count};
  TrackBuilder builder{reader.columns(), track};
  for (recording::Row row; reader.next(row);) builder.take(row);
  return track;
}

}  // namespace zerorate::truth
