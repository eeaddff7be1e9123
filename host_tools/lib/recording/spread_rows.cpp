#include "host_tools/lib/recording/spread_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "host_tools/lib/recording/error.hpp"

namespace zerorate::recording {
namespace {

constexpr std::size_t kReserved = 256;
constexpr std::string_view kCure =
    "Write them with more digits, or name a second column with --columns t_ns=NAME; a recording "
    "without usable stamps is read by --rows-at HZ.";

bool same_bits(float one, float other) {
  return std::bit_cast<std::uint32_t>(one) == std::bit_cast<std::uint32_t>(other);
}

bool same_rates(const Row& one, const Row& other) {
  return std::ranges::equal(one.rate_rad_s, other.rate_rad_s, same_bits);
}

bool same_values(const Row& one, const Row& other) {
  return same_rates(one, other) && same_bits(one.temperature_degc, other.temperature_degc) &&
         one.odometer_pulses == other.odometer_pulses && one.still == other.still &&
         same_bits(one.speed_m_s, other.speed_m_s) && same_bits(one.turn_rad_s, other.turn_rad_s) &&
         same_bits(one.ref_heading_rad, other.ref_heading_rad) &&
         std::ranges::equal(one.acceleration_m_s2, other.acceleration_m_s2, same_bits);
}

}  // namespace

SpreadRows::SpreadRows(std::unique_ptr<RowSource> rows, std::string name)
    : rows_(std::move(rows)), name_(std::move(name)) {
  group_.reserve(kReserved);
  next_.reserve(kReserved);
}

bool SpreadRows::next(Row& row) {
  if (given_ == group_.size()) {
    const bool is_first = stamps_ == 0;
    if (is_first) read(next_);
    std::swap(group_, next_);
    given_ = 0;
    if (group_.empty()) {
      next_.clear();  // the end may be asked for again
      rows_.rethrow();
      return false;
    }
    read(next_);
    if (next_.empty()) expect_stamps_with_digits();
    if (is_first && group_.size() > 1) {
      spread_first();
    } else {
      spread();
    }
  }
  row = group_[given_].row;
  line_ = group_[given_].line;
  ++given_;
  return true;
}

/// Reads the rows of the next stamp; none at the end.
void SpreadRows::read(Group& group) {
  group.clear();
  if (!peeked_) peek();
  if (!peeked_) return;
  const std::int64_t stamp_ns = peeked_->row.time_ns;
  for (; peeked_ && peeked_->row.time_ns == stamp_ns; peek()) {
    if (!group.empty() && is_copy(*peeked_, group.back())) {
      if (left_out_.repeated++ == 0) left_out_.first_repeated_line = peeked_->line;
    } else {
      group.push_back(*peeked_);
    }
    if (group.size() > kMostRowsAStamp) {
      throw Error{{name_, group.back().line},
                  fmt::format("one stamp in {} rows", group.size()),
                  "stamps that advance",
                  std::string(kCure)};
    }
  }
  count(group);
}

void SpreadRows::peek() {
  NumberedRow row;
  peeked_ = rows_.next(row) ? std::optional{row} : std::nullopt;
}

void SpreadRows::count(const Group& group) {
  ++stamps_;
  counted_ += group.size();
  if (group.size() > 1) {
    ++shared_stamps_;
    sharing_ += group.size();
  }
  if (!group_.empty()) {
    ++neighbours_;
    equal_neighbours_ += same_rates(group.front().row, group_.back().row) ? 1U : 0U;
  }
}

bool SpreadRows::is_copy(const NumberedRow& row, const NumberedRow& before) const {
  constexpr std::uint64_t kCoarse = 10;  // one neighbour of ten is equal where levels are wide
  return same_values(row.row, before.row) && equal_neighbours_ * kCoarse <= neighbours_;
}

/// Interval between the rows of the group: up to the next stamp, or the mean one.
std::int64_t SpreadRows::own_interval_ns() {
  const auto rows = static_cast<std::int64_t>(group_.size());
  const std::int64_t mean_ns = spread_rows_ > 0 ? spread_ns_ / spread_rows_ : 0;
  if (next_.empty()) return mean_ns;
  const std::int64_t interval_ns = next_.front().row.time_ns - group_.front().row.time_ns;
  if (next_.front().row.findings.has(Finding::clock_step)) {
    return std::min(mean_ns, interval_ns / rows);  // the pause behind it is made up
  }
  const std::int64_t median_ns = intervals_.value_ns();
  const bool is_gap = median_ns > 0 && (interval_ns - 1) / kGapPeriods >= median_ns;
  intervals_.add(interval_ns);
  if (is_gap) return std::min(mean_ns, interval_ns / rows);
  spread_ns_ += interval_ns;
  spread_rows_ += rows;
  return interval_ns / rows;
}

void SpreadRows::spread() {
  const std::int64_t interval_ns = own_interval_ns();
  for (std::size_t k = 1; k < group_.size(); ++k) {
    group_[k].row.time_ns += static_cast<std::int64_t>(k) * interval_ns;
    group_[k].row.findings.add(Finding::time_spread);
  }
}

/// The recording may begin within the rows of a stamp: they end at the next one, at the interval of
/// the rows behind it.
void SpreadRows::spread_first() {
  const std::int64_t stamp_ns = group_.front().row.time_ns;
  if (next_.empty() || !peeked_) return spread();
  const std::int64_t next_ns = next_.front().row.time_ns;
  const std::int64_t interval_ns =
      std::min((peeked_->row.time_ns - next_ns) / static_cast<std::int64_t>(next_.size()),
               (next_ns - stamp_ns) / static_cast<std::int64_t>(group_.size()));
  for (std::size_t k = 0; k < group_.size(); ++k) {
    group_[k].row.time_ns = next_ns - static_cast<std::int64_t>(group_.size() - k) * interval_ns;
    group_[k].row.findings.add(Finding::time_spread);
  }
}

void SpreadRows::expect_stamps_with_digits() const {
  constexpr std::uint64_t kFewestStamps = 10;
  constexpr std::uint64_t kFewestRows = 32;
  constexpr std::uint64_t kFewestLongStamps = 32;
  constexpr std::uint64_t kLong = 64;
  const bool is_exception = 2 * sharing_ < counted_ || sharing_ < 3 * shared_stamps_;
  const bool is_long = sharing_ > kLong * shared_stamps_;
  const std::uint64_t fewest = is_long ? kFewestLongStamps : kFewestStamps;
  if (shared_stamps_ >= fewest || counted_ < kFewestRows || is_exception) return;
  throw Error{{name_},
              fmt::format("only {} different stamp{} in {} rows: their digits were lost", stamps_,
                          stamps_ == 1 ? "" : "s", counted_),
              "stamps that advance with the rows",
              std::string(kCure)};
}

}  // namespace zerorate::recording
