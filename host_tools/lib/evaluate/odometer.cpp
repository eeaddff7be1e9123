#include "host_tools/lib/evaluate/odometer.hpp"

#include <algorithm>
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
      if (!was_moving_) pulses.push_back(at);  // a single pulse would be taken for creeping
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

/// Nothing tells when the vehicle moves.
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
      "the recording has no odometer_pulses and no still column: nothing tells when the vehicle "
      "moves. If the sensor was at rest all the time, add --schedule still=60,drive=300,seed=1; if "
      "the vehicle has no odometer, add --still-from gyro");
}

}  // namespace zerorate::evaluate
