#include "host_tools/lib/recording/ordered_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "core/base/time.hpp"
#include "host_tools/lib/recording/error.hpp"

namespace zerorate::recording {
namespace {

constexpr std::size_t kCapacity = 3 * kSortedRows;
constexpr std::size_t kMostStray = 3;
constexpr std::int64_t kLongestPeriod_ns = 100'000'000'000'000;  // keeps sums within 64 bits

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// Range of a counter [ns]; eight counts of its unit are whole nanoseconds.
constexpr std::int64_t range_of(double unit_ns, int bits) {
  return static_cast<std::int64_t>(unit_ns * 8.0) * (std::int64_t{1} << (bits - 3));
}

/// Times after which clocks begin again: counters of ns, us and ms.
constexpr std::array kCommonRanges_ns{range_of(1.0, 32), range_of(1e3, 16), range_of(1e3, 24),
                                      range_of(1e3, 32), range_of(1e6, 16), range_of(1e6, 24),
                                      range_of(1e6, 32)};
/// Ranges that count only where a clock goes from their end to zero: counters of 31 bits; those in
/// chips of 10, 25, 39.0625 and 100 us and of 1/32768 s; the second, half a day, the day and the
/// week.
constexpr std::array kOtherRanges_ns{
    range_of(1e3, 31),      range_of(1e6, 31),      range_of(10e3, 16),     range_of(10e3, 24),
    range_of(10e3, 32),     range_of(25e3, 16),     range_of(25e3, 24),     range_of(25e3, 32),
    range_of(39'062.5, 16), range_of(39'062.5, 24), range_of(39'062.5, 32), range_of(100e3, 16),
    range_of(100e3, 24),    range_of(100e3, 32),    2 * kSecond_ns,         512 * kSecond_ns,
    131'072 * kSecond_ns,   1 * kSecond_ns,         43'200 * kSecond_ns,    86'400 * kSecond_ns,
    604'800 * kSecond_ns,
};

}  // namespace

OrderedRows::OrderedRows(std::unique_ptr<RowSource> rows, std::string name)
    : rows_(std::move(rows)), name_(std::move(name)) {
  ahead_.reserve(kCapacity);
}

LeftOut OrderedRows::left_out() const {
  return left_out_ + rows_.source().left_out();
}

bool OrderedRows::next(Row& row) {
  fill();
  if (begin_ == judged_) {
    rows_.rethrow();
    return false;
  }
  row = ahead_[begin_].row;
  line_ = ahead_[begin_].line;
  given_ns_ = row.time_ns;
  ++begin_;
  ++given_;
  return true;
}

/// Judges rows until one has as many judged ones behind it as may still be sorted in before them.
void OrderedRows::fill() {
  while (judged_ - begin_ <= kSortedRows) {
    while (!rows_.is_at_end() && ahead_.size() - judged_ <= kSortedRows) {
      if (ahead_.size() == kCapacity) {
        ahead_.erase(ahead_.begin(), ahead_.begin() + static_cast<std::ptrdiff_t>(begin_));
        judged_ -= std::exchange(begin_, 0);
      }
      NumberedRow read;
      if (!rows_.next(read)) break;
      ahead_.push_back(read);
      expect_one_time_line(read);
    }
    if (judged_ == ahead_.size()) return;
    judge_next();
  }
}

void OrderedRows::expect_one_time_line(const NumberedRow& row) {
  turns_.add(row.row.time_ns);
  if (turns_.run_back_between_bursts()) {
    throw Error{{name_, row.line},
                "stamps of bursts that run backwards again and again: the clock begins again while "
                "a burst is read",
                "stamps that advance, or begin again after many bursts",
                "--rows-at HZ reads the rows without their stamps."};
  }
  if (!turns_.are_there()) return;
  const std::vector<std::string> columns = ignored_columns();
  throw Error{
      {name_, row.line},
      "rows that take turns, each with a time line of its own: several sensors in one file",
      "stamps of one sensor",
      fmt::format("One of them is picked by --where COLUMN=VALUE{}{}; rows of one sensor in "
                  "the order of the file are read by --rows-at HZ.",
                  columns.empty() ? "" : ", where COLUMN is one of ", fmt::join(columns, ", "))};
}

void OrderedRows::judge_next() {
  Row& row = ahead_[judged_].row;
  if (given_ == 0 && judged_ == 0) latest_ns_ = row.time_ns;
  const std::int64_t at_ns = on_time_line(row);
  if (at_ns < latest_ns_) {
    judge_backwards();
    return;
  }
  if (!core::is_in_range(core::Instant::from_ns(at_ns))) {
    throw Error{{name_, ahead_[judged_].line},
                "stamps that jump over more than 146 years in all",
                "stamps of one clock",
                "Cut the recording where its clock was set; --rows-at HZ reads it without them."};
  }
  row.time_ns = at_ns;
  latest_ns_ = at_ns;
  ++judged_;
}

void OrderedRows::judge_backwards() {
  constexpr std::size_t kSoon = 16;
  measure_period();
  if (is_wrap()) return;
  const std::size_t end = end_of_late();
  const std::size_t later = first_later(on_time_line(ahead_[judged_].row));
  const bool is_within_reach = given_ == 0 || earliest_until(end) >= given_ns_;
  const bool is_soon = judged_ - later <= kSoon && end < ahead_.size() && end - judged_ <= kSoon;
  if (!(is_within_reach && is_soon) && leave_out_stray(later, end)) return;
  if (is_within_reach && (is_soon || fills_a_hole(later, end)) && !counts_again(later, end)) {
    sort(later, end);
  } else {
    step_clock();
  }
}

bool OrderedRows::is_wrap() {
  const std::optional<std::int64_t> range_ns = range_of_wrap(latest_ns_);
  if (!range_ns) return false;
  offset_ns_ += *range_ns;
  ahead_[judged_].row.findings.add(Finding::counter_wrapped);
  judge_next();
  return true;
}

/// Chooses of several ranges the one with the shortest interval over its end.
std::optional<std::int64_t> OrderedRows::range_of_wrap(std::int64_t latest_ns) const {
  const std::int64_t before_ns = latest_ns - offset_ns_;
  const Row& row = ahead_[judged_].row;
  // Rows of a burst share a stamp, and the stamps are further apart than the rows.
  const std::int64_t usual_ns = std::max(period_ns_, longest_step_ns_ / kGapPeriods);
  std::optional<std::int64_t> best_ns;
  const auto judge = [&](std::int64_t range_ns, bool is_common) {
    const std::int64_t interval_ns = row.time_ns + range_ns - before_ns;
    if (interval_ns <= 0 || range_ns < 20 * usual_ns) return;
    const bool is_at_its_end = (before_ns < range_ns && row.time_ns >= 0) ||
                               (before_ns < range_ns / 2 && row.time_ns >= -range_ns / 2 &&
                                row.time_ns < 0 && before_ns > 0);
    const bool is_sample =
        is_common && interval_ns >= period_ns_ / 2 && interval_ns <= 2 * usual_ns;
    if (!(is_at_its_end && interval_ns <= 10 * usual_ns) &&
        !(is_sample && range_ns > 1'000 * usual_ns))
      return;
    if (!best_ns || range_ns < *best_ns) best_ns = range_ns;
  };
  for (const std::int64_t range_ns : kCommonRanges_ns) judge(range_ns, true);
  for (const std::int64_t range_ns : kOtherRanges_ns) judge(range_ns, false);
  return best_ns;
}

std::int64_t OrderedRows::on_time_line(const Row& row) const {
  std::int64_t at_ns = 0;
  if (!__builtin_add_overflow(row.time_ns, offset_ns_, &at_ns)) return at_ns;
  return offset_ns_ > 0 ? std::numeric_limits<std::int64_t>::max()
                        : std::numeric_limits<std::int64_t>::min();
}

std::int64_t OrderedRows::earliest_until(std::size_t end) const {
  std::int64_t earliest_ns = latest_ns_;
  for (std::size_t k = judged_; k < end; ++k) {
    earliest_ns = std::min(earliest_ns, on_time_line(ahead_[k].row));
  }
  return earliest_ns;
}

std::size_t OrderedRows::end_of_late() const {
  std::size_t end = judged_;
  while (end < ahead_.size() && on_time_line(ahead_[end].row) < latest_ns_) ++end;
  return end;
}

std::size_t OrderedRows::first_later(std::int64_t time_ns) const {
  std::size_t first = judged_;
  while (first > begin_ && ahead_[first - 1].row.time_ns > time_ns) --first;
  return first;
}

std::size_t OrderedRows::rows_until(std::int64_t time_ns, std::size_t first) const {
  std::size_t end = first;
  while (end < judged_ && ahead_[end].row.time_ns <= time_ns) ++end;
  return end - first;
}

/// Late rows that were written between others would double the rows in their time.
bool OrderedRows::fills_a_hole(std::size_t later, std::size_t end) const {
  const std::int64_t earliest_ns = earliest_until(end);
  std::int64_t until_ns = end < ahead_.size() ? latest_ns_ : earliest_ns;
  for (std::size_t k = judged_; k < end; ++k) {
    until_ns = std::max(until_ns, on_time_line(ahead_[k].row));
  }
  // They go on behind a row, or lead to one.
  const bool has_before = later > begin_ || given_ > 0;
  const std::int64_t before_ns = later > begin_ ? ahead_[later - 1].row.time_ns : given_ns_;
  const bool goes_on = has_before && earliest_ns - before_ns <= longest_step_ns_;
  if (!goes_on && ahead_[later].row.time_ns - until_ns > longest_step_ns_) return false;
  const std::size_t rows = end - judged_ + rows_until(until_ns, later);
  const double room = static_cast<double>(until_ns - earliest_ns) / static_cast<double>(period_ns_);
  return static_cast<double>(rows) <= 1.5 * room + 8.0;
}

/// A clock set back, or a leap second, gives each stamp twice, in order, and then goes on without a
/// step. A buffer that is written twice has the same rates, too.
bool OrderedRows::counts_again(std::size_t later, std::size_t end) const {
  const std::size_t late = end - judged_;
  if (late <= kMostStray || end == ahead_.size()) return false;
  const auto stamp = [&](std::size_t k) { return on_time_line(ahead_[k].row); };
  if (stamp(end) - stamp(end - 1) > 2 * period_ns_) return false;
  for (std::size_t k = judged_ + 1; k < end; ++k) {
    if (stamp(k) <= stamp(k - 1)) return false;
  }
  const bool is_copy = later > begin_ && ahead_[later - 1].row.time_ns == stamp(judged_) &&
                       ahead_[later - 1].row.rate_rad_s == ahead_[judged_].row.rate_rad_s;
  return !is_copy && 4 * rows_until(stamp(end - 1), later) >= 3 * late;
}

bool OrderedRows::continues(std::int64_t from_ns, std::int64_t to_ns, std::size_t rows) const {
  return to_ns >= from_ns &&
         to_ns - from_ns <= static_cast<std::int64_t>(rows + kGapPeriods) * period_ns_;
}

bool OrderedRows::leave_out_stray(std::size_t later, std::size_t end) {
  if (end < ahead_.size() && end - judged_ <= kMostStray &&
      continues(latest_ns_, on_time_line(ahead_[end].row), end - judged_)) {
    leave_out(judged_, end);
    return true;
  }
  // Late rows that lead to the latest stamp show that it was only early.
  const bool is_early =
      end < ahead_.size() && latest_ns_ - on_time_line(ahead_[end - 1].row) <= longest_step_ns_;
  if (is_early) return false;
  for (std::size_t ahead = 1; ahead <= std::min(kMostStray, judged_); ++ahead) {
    const std::size_t first = judged_ - ahead;
    if (first < begin_ || first == 0) return false;
    const std::int64_t before_ns = first > begin_ ? ahead_[first - 1].row.time_ns : given_ns_;
    const bool goes_on =
        first == later && continues(before_ns, on_time_line(ahead_[judged_].row), ahead);
    if (!goes_on && !range_of_wrap(before_ns)) continue;
    leave_out(first, judged_);
    judged_ = first;
    latest_ns_ = before_ns;
    return true;
  }
  return false;
}

void OrderedRows::leave_out(std::size_t first, std::size_t end) {
  if (left_out_.stray == 0) left_out_.first_stray_line = ahead_[first].line;
  count_disorder(ahead_[first].line, end - first, left_out_.stray);
  ahead_.erase(ahead_.begin() + static_cast<std::ptrdiff_t>(first),
               ahead_.begin() + static_cast<std::ptrdiff_t>(end));
}

void OrderedRows::sort(std::size_t later, std::size_t end) {
  const bool is_early = judged_ - later < end - judged_;  // the fewer are those out of their place
  const std::size_t first = first_later(earliest_until(end));
  for (std::size_t k = judged_; k < end; ++k) ahead_[k].row.time_ns = on_time_line(ahead_[k].row);
  for (std::size_t k = is_early ? later : judged_; k < (is_early ? judged_ : end); ++k) {
    ahead_[k].row.findings.add(Finding::time_sorted);
  }
  const auto at = [&](std::size_t k) { return ahead_.begin() + static_cast<std::ptrdiff_t>(k); };
  std::stable_sort(at(first), at(end), [](const auto& one, const auto& other) {
    return one.row.time_ns < other.row.time_ns;
  });
  judged_ = end;
}

void OrderedRows::step_clock() {
  NumberedRow& row = ahead_[judged_];
  offset_ns_ = latest_ns_ + std::max(kPauseAtClockStep_ns, 20 * period_ns_) - row.row.time_ns;
  row.row.findings.add(Finding::clock_step);
  count_disorder(row.line, 1, steps_);
  judge_next();
}

void OrderedRows::count_disorder(std::uint64_t line, std::uint64_t more, std::uint64_t& count) {
  constexpr std::uint64_t kFewest = 40;
  constexpr std::uint64_t kOneOf = 50;
  const std::uint64_t rows = given_ + (judged_ - begin_);
  count += more;
  if (count <= kFewest || count <= rows / kOneOf) return;
  throw Error{
      {name_, line},
      fmt::format("the {}th time that runs backwards, in {} rows", count, rows),
      "stamps that advance",
      "Rows of several sensors in turn? One is picked by --where COLUMN=VALUE; rows without "
      "usable stamps are read by --rows-at HZ."};
}

void OrderedRows::measure_period() {
  constexpr std::uint64_t kRemeasured = 1'000;
  const std::uint64_t row = given_ + (judged_ - begin_);
  if (period_ns_ > 0 && row < measured_at_ + kRemeasured) return;
  measured_at_ = row;
  std::vector<std::int64_t> intervals;
  for (std::size_t k = begin_ + 1; k < ahead_.size(); ++k) {
    const std::int64_t interval_ns = ahead_[k].row.time_ns - ahead_[k - 1].row.time_ns;
    if (k != judged_ && interval_ns >= 0 && interval_ns < kLongestPeriod_ns)
      intervals.push_back(interval_ns);
  }
  std::ranges::sort(intervals);
  const auto advancing = std::ranges::upper_bound(intervals, 0);
  period_ns_ = 1;
  longest_step_ns_ = kGapPeriods;
  if (advancing == intervals.end()) return;
  const std::int64_t median_ns = advancing[(intervals.end() - advancing) / 2];
  longest_step_ns_ = kGapPeriods * median_ns;
  const auto gaps = std::ranges::upper_bound(intervals, longest_step_ns_);
  const std::int64_t sum_ns = std::accumulate(intervals.begin(), gaps, std::int64_t{0});
  period_ns_ = std::max<std::int64_t>(1, sum_ns / (gaps - intervals.begin()));
}

}  // namespace zerorate::recording
