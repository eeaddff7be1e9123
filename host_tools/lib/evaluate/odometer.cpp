#include "host_tools/lib/evaluate/odometer.hpp"

#include <fast_float/fast_float.h>
#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace zerorate::evaluate {

namespace {

/// Wheel pulses of a vehicle that is known to move or not at each row: one every interval while it
/// moves. The interval is short against any settle time.
class RegularPulses {
 public:
  explicit RegularPulses(core::Duration sample_period)
      : interval_(std::min(sample_period, core::Duration::milliseconds(100))) {}

  void until(core::Instant at, bool moving, std::vector<core::Instant>& pulses) {
    if (moving) {
      const core::Instant first = was_moving_ ? newest_ + interval_ : at;
      // A single pulse would be taken for creeping, two at one time for a contact that bounces.
      if (!was_moving_) pulses.push_back(at - core::Duration::milliseconds(25));
      for (core::Instant pulse = first; pulse <= at; pulse = pulse + interval_) {
        // A hole in the recording needs no pulses of its own: the newest one is what counts.
        if (at - pulse > core::Duration::seconds(1)) pulse = at - core::Duration::seconds(1);
        pulses.push_back(pulse);
        newest_ = pulse;
      }
    }
    was_moving_ = moving;
  }

 private:
  core::Duration interval_;
  core::Instant newest_;
  bool was_moving_ = false;
};

class ScheduledOdometer final : public Odometer {
 public:
  ScheduledOdometer(const ScheduleParams& params, core::Instant start, core::Duration sample_period)
      : schedule_(params, start), regular_(sample_period) {}

  bool pulses_until(core::Instant at, const recording::Row& /*row*/,
                    std::vector<core::Instant>& pulses) override {
    const bool moving = schedule_.is_moving(at);
    regular_.until(at, moving, pulses);
    return moving;
  }

 private:
  Schedule schedule_;
  RegularPulses regular_;
};

class StillColumn final : public Odometer {
 public:
  explicit StillColumn(core::Duration sample_period) : regular_(sample_period) {}

  bool pulses_until(core::Instant at, const recording::Row& row,
                    std::vector<core::Instant>& pulses) override {
    regular_.until(at, !row.still, pulses);
    return !row.still;
  }

 private:
  RegularPulses regular_;
};

/// No column gives the motion of the vehicle.
class NoOdometer final : public Odometer {
 public:
  bool pulses_until(core::Instant /*at*/, const recording::Row& /*row*/,
                    std::vector<core::Instant>& /*pulses*/) override {
    return false;
  }
};

/// A cumulative count: its increments are spread evenly over the time since the row before. A count
/// that falls was reset: the vehicle counts as moving then.
class PulseColumn final : public Odometer {
 public:
  bool pulses_until(core::Instant at, const recording::Row& row,
                    std::vector<core::Instant>& pulses) override {
    const std::int64_t counted = row.odometer_pulses - count_;
    const bool moved = started_ && counted != 0;
    if (moved) {
      // The node needs to know that there were pulses, how close together they came and when the
      // newest one was, not each of a thousand.
      const std::int64_t spread = counted < 0 ? 1 : counted;
      const core::Duration apart = (at - previous_) / spread;
      for (std::int64_t i = std::min(spread, kMostPerRow) - 1; i >= 0; --i) {
        pulses.push_back(at - apart * i);
      }
    }
    started_ = true;
    count_ = row.odometer_pulses;
    previous_ = at;
    if (moved) newest_motion_ = at;
    return moved || (newest_motion_ && at - *newest_motion_ < kStandstillAfter);
  }

 private:
  static constexpr std::int64_t kMostPerRow = 16;
  /// For the evaluation only: a row without a pulse in the midst of a drive still belongs to it.
  static constexpr core::Duration kStandstillAfter = core::Duration::seconds(1);

  bool started_ = false;
  std::int64_t count_ = 0;
  core::Instant previous_;
  std::optional<core::Instant> newest_motion_;
};

}  // namespace

std::unique_ptr<Odometer> make_odometer(const recording::Columns& columns,
                                        const std::optional<ScheduleParams>& schedule,
                                        core::Instant start, core::Duration sample_period,
                                        bool is_needed) {
  if (schedule) return std::make_unique<ScheduledOdometer>(*schedule, start, sample_period);
  if (columns.odometer) return std::make_unique<PulseColumn>();
  if (columns.still) return std::make_unique<StillColumn>(sample_period);
  if (!is_needed) return std::make_unique<NoOdometer>();
  throw std::invalid_argument(
      "the recording has no odometer_pulses and no still column: it does not show when the vehicle "
      "moves. If the sensor was at rest all the time, add --schedule still=60,drive=300,seed=1; if "
      "the vehicle has no odometer, add --still-from gyro");
}

namespace {

template <class Number>
Number parse_number(std::string_view key, std::string_view text) {
  Number number{};
  const auto* const end = text.data() + text.size();
  const auto result = [&] {
    if constexpr (std::is_integral_v<Number>) {
      return std::from_chars(text.data(), end, number);
    } else {
      return fast_float::from_chars(text.data(), end, number);
    }
  }();
  if (text.empty() || result.ec != std::errc{} || result.ptr != end) {
    throw std::invalid_argument(fmt::format(
        "schedule: {} is '{}', expected a number, as in still=60,drive=300,seed=1", key, text));
  }
  return number;
}

double parse_mean_seconds(std::string_view key, std::string_view text) {
  const auto seconds = parse_number<double>(key, text);
  if (!(seconds > 0.0) || !std::isfinite(seconds)) {
    throw std::invalid_argument(
        fmt::format("schedule: {} is '{}', expected a positive mean length in seconds", key, text));
  }
  return seconds;
}

void set(ScheduleParams& params, std::string_view key, std::string_view value) {
  if (key == "still") {
    params.still_s = parse_mean_seconds(key, value);
  } else if (key == "drive") {
    params.drive_s = parse_mean_seconds(key, value);
  } else if (key == "seed") {
    params.seed = parse_number<std::uint64_t>(key, value);
  } else {
    throw std::invalid_argument(
        fmt::format("schedule: unknown key '{}', expected still, drive or seed", key));
  }
}

}  // namespace

ScheduleParams parse_schedule(std::string_view text) {
  ScheduleParams params;
  while (!text.empty()) {
    const auto comma = text.find(',');
    const std::string_view item = text.substr(0, comma);
    text = comma == std::string_view::npos ? std::string_view{} : text.substr(comma + 1);
    const auto equals = item.find('=');
    if (equals == std::string_view::npos) {
      throw std::invalid_argument(fmt::format(
          "schedule: '{}' has no '=', expected still=SECONDS,drive=SECONDS,seed=N", item));
    }
    set(params, item.substr(0, equals), item.substr(equals + 1));
  }
  return params;
}

Schedule::Schedule(const ScheduleParams& params, core::Instant start)
    : params_(params), stream_(params.seed), phase_end_(start) {
  phase_end_ = start + next_length();
}

bool Schedule::is_moving(core::Instant at) {
  while (at >= phase_end_) {
    moving_ = !moving_;
    phase_end_ = phase_end_ + next_length();
  }
  return moving_;
}

core::Duration Schedule::next_length() {
  const double mean_s = moving_ ? params_.drive_s : params_.still_s;
  const double length_s = -mean_s * std::log(stream_.uniform(draws_++));
  return core::Duration::nanoseconds(std::llround(length_s * 1e9));
}

}  // namespace zerorate::evaluate
