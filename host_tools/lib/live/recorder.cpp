#include "host_tools/lib/live/recorder.hpp"

#include <cstdlib>
#include <limits>
#include <utility>

#include "host_tools/lib/recording/error.hpp"

namespace zerorate::live {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
/// Messages after which all columns have shown: the chips give a temperature at least once a
/// second.
constexpr std::int64_t kColumnsKnownAfter_ns = 2 * kSecond_ns;
/// Datagrams may overtake each other by this many; a lower number is one of a node that restarted.
constexpr std::int32_t kOvertaken = 8;

}  // namespace

Recorder::Recorder(RecorderSettings settings) : settings_(std::move(settings)) {
  if (!settings_.resumes) return;
  writer_.emplace(settings_.path);
  check_columns();
  const recording::HeldRecording& held = writer_->held();
  last_time_ns_ = held.last_time_ns;
  pulses_ = held.last_odometer_pulses;
  recorded_ns_ = held.recorded_ns;
  held_rows_ = held.rows;
}

/// Whether a file that goes on has no more columns than messages can fill.
void Recorder::check_columns() const {
  const recording::Columns& columns = writer_->columns();
  const std::size_t axes = settings_.axis ? 1 : recording::kMaxAxes;
  const bool is_too_much =
      columns.still || columns.ref_heading || columns.ref_rate || columns.ref_speed;
  if (columns.axis_count == axes && !is_too_much) return;
  throw recording::Error{{settings_.path.string()},
                         "other columns than this recording has",
                         "the same axes, and no still or reference column",
                         "Name the same axis, or choose another file."};
}

void Recorder::take(const wire::NumberedMessage& numbered, std::int64_t utc_ns) {
  if (!follow_number(numbered)) return;
  const app::RateMessage& message = numbered.message;
  if (!message.has_rate()) {
    ++counts_.without_rate;
    return;
  }
  if (!is_anchored_) anchor(message.time, utc_ns);
  count_pulses(message);
  has_temperature_ |= message.temperature.has_value();
  has_pulses_ |= message.odometer_pulses.has_value();
  has_acceleration_ |= message.acceleration.has_value();
  const recording::Row row = row_of(message);
  if (writer_) {
    write(row);
    return;
  }
  waiting_.push_back(row);
  if (row.time_ns - waiting_.front().time_ns >= kColumnsKnownAfter_ns) begin_file();
}

/// Counts what is missing before the message. @return false for one that came too late
bool Recorder::follow_number(const wire::NumberedMessage& numbered) {
  const std::optional<wire::NumberedMessage> before = std::exchange(newest_, numbered);
  if (!before) return true;
  const auto step = static_cast<std::int32_t>(numbered.sequence - before->sequence);
  if (step > 0 && has_jumped(*before, numbered) && !is_borne_out(numbered)) {
    newest_ = before;
    doubted_ = numbered;
    ++counts_.out_of_order;
    return false;
  }
  if (step > 0 && !has_jumped(*before, numbered)) {
    counts_.lost += static_cast<std::uint64_t>(step) - 1;
  } else if (step > -kOvertaken && numbered.message.time <= before->message.time) {
    newest_ = before;
    ++counts_.out_of_order;
    return false;
  } else {
    ++counts_.restarts;
    is_anchored_ = false;
  }
  return true;
}

/// A node sends four messages a second and more: one whose time runs further ahead than its number
/// is damaged, or the clock has changed.
bool Recorder::has_jumped(const wire::NumberedMessage& before,
                          const wire::NumberedMessage& numbered) {
  const std::int64_t step = numbered.sequence - before.sequence;
  const core::Duration longest = core::Duration::seconds(10) + core::Duration::seconds(1) * step;
  return numbered.message.time - before.message.time > longest;
}

/// Whether the message before jumped to the same time.
bool Recorder::is_borne_out(const wire::NumberedMessage& numbered) const {
  return doubted_ && static_cast<std::int32_t>(numbered.sequence - doubted_->sequence) > 0 &&
         numbered.message.time > doubted_->message.time && !has_jumped(*doubted_, numbered);
}

void Recorder::anchor(core::Instant time, std::int64_t utc_ns) {
  const bool is_first = counts_.restarts == 0;
  const std::int64_t offset_ns = utc_ns - time.ns();
  // A node that restarts on the same machine has the same clock: the offset of before is the better
  // one, because this message may have been late.
  if (is_first || std::abs(offset_ns - offset_ns_) > kSecond_ns) offset_ns_ = offset_ns;
  if (last_time_ns_ && time.ns() + offset_ns_ <= *last_time_ns_) {
    offset_ns_ = *last_time_ns_ + 2 * recording::kLongestInterval_ns - time.ns();
    ++counts_.set_back;
  }
}

void Recorder::count_pulses(const app::RateMessage& message) {
  const std::uint32_t now = message.odometer_pulses.value_or(node_pulses_);
  if (is_anchored_) {
    pulses_ += static_cast<std::uint32_t>(now - node_pulses_);
  } else {
    if (last_time_ns_) pulses_ += 1;
    if (counts_.restarts > 0) pulses_ += now;
    is_anchored_ = true;
  }
  node_pulses_ = now;
}

recording::Row Recorder::row_of(const app::RateMessage& message) const {
  recording::Row row{.time_ns = message.time.ns() + offset_ns_, .odometer_pulses = pulses_};
  for (std::size_t i = 0; i < message.axes.size(); ++i) {
    row.rate_rad_s.at(i) = message.axes.at(i).measured.in(core::rad_per_s);
  }
  if (settings_.axis) row.rate_rad_s[0] = row.rate_rad_s.at(*settings_.axis);
  if (message.temperature) row.temperature_degc = message.temperature->degc();
  for (std::size_t i = 0; i < row.acceleration_m_s2.size() && message.acceleration; ++i) {
    row.acceleration_m_s2.at(i) = message.acceleration->at(i).in(core::m_per_s2);
  }
  return row;
}

void Recorder::begin_file() {
  const recording::Columns columns{.axis_count = settings_.axis ? 1 : recording::kMaxAxes,
                                   .temperature = has_temperature_,
                                   .odometer = has_pulses_,
                                   .acceleration = has_acceleration_};
  writer_.emplace(settings_.path, columns, settings_.comment);
  for (const recording::Row& row : waiting_) write(row);
  waiting_.clear();
}

void Recorder::write(const recording::Row& row) {
  if (writer_->columns().odometer && !has_pulses_) {
    throw recording::Error{{settings_.path.string()},
                           "messages without an odometer",
                           "pulse counts, as the recording has them",
                           "Give the node its odometer again, or begin another file."};
  }
  if (last_time_ns_) {
    const std::int64_t interval_ns = row.time_ns - *last_time_ns_;
    if (interval_ns <= 0) {
      ++counts_.out_of_order;
      return;
    }
    if (interval_ns > recording::kLongestInterval_ns) {
      ++counts_.pauses;
    } else {
      recorded_ns_ += interval_ns;
    }
  }
  last_time_ns_ = row.time_ns;
  writer_->write(row);
  ++counts_.rows;
}

void Recorder::flush() {
  if (writer_) writer_->flush();
}

void Recorder::finish() {
  if (!writer_ && !waiting_.empty()) begin_file();
  flush();
}

}  // namespace zerorate::live
