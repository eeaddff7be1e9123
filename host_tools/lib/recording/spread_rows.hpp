/// @file
/// Rows that share a stamp, each at a time of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_tools/lib/recording/findings.hpp"
#include "host_tools/lib/recording/row_source.hpp"
#include "host_tools/lib/recording/rows_ahead.hpp"

namespace zerorate::recording {

/// Spreads rows with equal stamps, as those of a FIFO that was read in bursts or of a clock with
/// few digits, evenly to the next stamp; before a gap and at the end by the mean interval of a
/// sample (`time_spread`). A copy of the row before, in a recording whose neighbours differ, is
/// left out. Memory: the rows of one stamp. Throws Error where a stamp has more than
/// kMostRowsAStamp rows, and where less than ten stamps serve many rows, or less than 32 more than
/// 64 each: the digits of the stamps were lost.
class SpreadRows : public RowSource {
 public:
  static constexpr std::size_t kMostRowsAStamp = 65'536;

  /// @param rows  in the order of time  @param name  of the recording, for messages
  SpreadRows(std::unique_ptr<RowSource> rows, std::string name);

  [[nodiscard]] const Columns& columns() const override { return rows_.source().columns(); }
  [[nodiscard]] bool next(Row& row) override;
  [[nodiscard]] std::uint64_t line() const override { return line_; }
  [[nodiscard]] std::optional<double> fraction_read() const override {
    return rows_.source().fraction_read();
  }
  [[nodiscard]] std::vector<std::string> ignored_columns() const override {
    return rows_.source().ignored_columns();
  }
  [[nodiscard]] LeftOut left_out() const override { return left_out_ + rows_.source().left_out(); }

 private:
  using Group = std::vector<NumberedRow>;

  void read(Group& group);
  void peek();
  [[nodiscard]] bool is_copy(const NumberedRow& row, const NumberedRow& before) const;
  void spread();
  void spread_first();
  [[nodiscard]] std::int64_t own_interval_ns();
  void count(const Group& group);
  void expect_stamps_with_digits() const;

  RowsAhead rows_;
  std::string name_;
  Group group_;  ///< rows that are given
  std::size_t given_ = 0;
  Group next_;  ///< rows of the stamp behind them
  std::optional<NumberedRow> peeked_;
  IntervalMedian intervals_;      ///< between stamps
  std::int64_t spread_ns_ = 0;    ///< sum of the intervals between stamps, gaps left out
  std::int64_t spread_rows_ = 0;  ///< rows in this sum
  std::uint64_t stamps_ = 0;
  std::uint64_t shared_stamps_ = 0;  ///< stamps with several rows
  std::uint64_t sharing_ = 0;        ///< rows of these
  std::uint64_t counted_ = 0;        ///< rows of these stamps
  std::uint64_t neighbours_ = 0;     ///< rows with a stamp of their own
  std::uint64_t equal_neighbours_ = 0;
  std::uint64_t line_ = 0;
  LeftOut left_out_;
};

}  // namespace zerorate::recording
