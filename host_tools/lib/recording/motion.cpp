#include "host_tools/lib/recording/motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace zerorate::recording {

WithMotion::WithMotion(std::unique_ptr<RowSource> rates, std::unique_ptr<RowSource> motion,
                       const SpeedRule& rule)
    : rates_(std::move(rates)),
      motion_(std::move(motion)),
      rule_(rule),
      columns_(rates_->columns()),
      motion_columns_(motion_ ? motion_->columns() : columns_) {
  columns_.odometer = motion_columns_.odometer || rule_.metres_per_pulse.has_value();
  columns_.still = !columns_.odometer;
  columns_.speed = false;
}

bool WithMotion::next(Row& row) {
  if (ahead_.empty() && !read_rates()) return false;
  hear_until(ahead_.front().row.time_ns);
  row = ahead_.front().row;
  line_ = ahead_.front().line;
  ahead_.pop_front();
  const bool is_known = is_known_at(row.time_ns);
  const bool moves_soon = after_ && after_->moves && after_->at_ns - row.time_ns <= patience_ns();
  if (!is_known) {
    row.findings.add(Finding::motion_unknown);
    ++pulses_;
  }
  row.still = columns_.still && is_known && !before_->moves && !moves_soon;
  row.odometer_pulses = columns_.odometer ? pulses_ : 0;
  return true;
}

bool WithMotion::read_rates() {
  NumberedRow read;
  if (!rates_->next(read.row)) return false;
  read.line = rates_->line();
  ahead_.push_back(read);
  if (!motion_) {
    if (const auto word = word_of(read.row)) heard_.push_back(*word);
  }
  return true;
}

/// Moves on to the words around a moment.
void WithMotion::hear_until(std::int64_t time_ns) {
  while (!after_ || after_->at_ns <= time_ns) {
    if (after_) {
      before_ = after_;
      pulses_ += after_->pulses;
    }
    after_ = hear(time_ns + patience_ns());
    if (!after_) return;
  }
}

/// The next word; nullopt at the end, and where there is none before `latest_ns`.
std::optional<WithMotion::Word> WithMotion::hear(std::int64_t latest_ns) {
  if (!motion_) return hear_beside(latest_ns);
  for (Row row; motion_->next(row);) {
    if (const auto word = word_of(row)) return word;
  }
  return std::nullopt;
}

std::optional<WithMotion::Word> WithMotion::hear_beside(std::int64_t latest_ns) {
  while (heard_.empty() && ahead_.back().row.time_ns - rule_.delay.ns() <= latest_ns) {
    if (!read_rates()) break;
  }
  if (heard_.empty()) return std::nullopt;
  const Word word = heard_.front();
  heard_.pop_front();
  return word;
}

/// nullopt where the row has nothing new: no speed, or a stamp that is not later.
std::optional<WithMotion::Word> WithMotion::word_of(const Row& row) {
  const std::int64_t at_ns = row.time_ns - rule_.delay.ns();
  const bool is_silent =
      !motion_columns_.odometer && !motion_columns_.still && !std::isfinite(fastest_wheel_m_s(row));
  if (is_silent || (latest_word_ns_ && at_ns <= *latest_word_ns_)) return std::nullopt;
  Word word{.at_ns = at_ns};
  if (motion_columns_.odometer) {
    word.pulses = last_motion_ ? std::abs(row.odometer_pulses - last_motion_->odometer_pulses) : 0;
    word.moves = word.pulses > 0;
  } else if (motion_columns_.still) {
    word.moves = !row.still;
  } else {
    word = word_of_speed(row, at_ns);
  }
  if (latest_word_ns_) interval_.add(at_ns - *latest_word_ns_);
  latest_word_ns_ = at_ns;
  last_motion_ = row;
  return word;
}

/// Speed of the wheel on the outside of the turn: a robot that turns on the spot is in motion.
double WithMotion::fastest_wheel_m_s(const Row& row) const {
  return std::abs(double{row.speed_m_s}) + 0.5 * rule_.track_m * std::abs(double{row.turn_rad_s});
}

WithMotion::Word WithMotion::word_of_speed(const Row& row, std::int64_t at_ns) {
  const double speed = fastest_wheel_m_s(row);
  Word word{.at_ns = at_ns, .moves = speed > rule_.dead_band_m_s};
  if (!rule_.metres_per_pulse || !last_motion_ || at_ns - *latest_word_ns_ > patience_ns())
    return word;
  const double before = fastest_wheel_m_s(*last_motion_);
  const double metres = 0.5e-9 * (speed + before) * static_cast<double>(at_ns - *latest_word_ns_);
  if (!word.moves && before <= rule_.dead_band_m_s) return word;
  rest_of_pulse_ += metres / *rule_.metres_per_pulse;
  word.pulses = static_cast<std::int64_t>(rest_of_pulse_);
  rest_of_pulse_ -= static_cast<double>(word.pulses);
  return word;
}

bool WithMotion::is_known_at(std::int64_t time_ns) const {
  return before_ && before_->at_ns <= time_ns && time_ns - before_->at_ns <= patience_ns();
}

std::int64_t WithMotion::patience_ns() const {
  constexpr std::int64_t kShortest_ns = 1'000'000'000;
  return std::max(kShortest_ns, 3 * interval_.value_ns());
}

}  // namespace zerorate::recording
