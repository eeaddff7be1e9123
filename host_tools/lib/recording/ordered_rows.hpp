/// @file
/// Rows of a clock that was set or wrapped, or out of order, on a time line that never runs
/// backwards.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_tools/lib/recording/row_source.hpp"
#include "host_tools/lib/recording/rows_ahead.hpp"
#include "host_tools/lib/recording/stamps_in_turn.hpp"

namespace zerorate::recording {

/// Longest disorder that is put right, in rows: the distance over which the rows are sorted.
inline constexpr std::size_t kSortedRows = 4096;

/// Time between the rows before and after a clock step, whose true length nothing measures: two
/// seconds as `zerorate record` writes them, and at least twenty sample periods.
inline constexpr std::int64_t kPauseAtClockStep_ns = 2'000'000'000;

/// Judges each stamp that is before the latest one, by the rows around it:
///
/// - a counter of 16, 24 or 32 bits that began again (`counter_wrapped`) counts on;
/// - rows that came late, or in blocks, go where their stamps belong (`time_sorted`), unless the
///   rows of that time are there already;
/// - one to three rows with a stamp far from those of their neighbours are left out;
/// - else the clock was set back, or the logger began again (`clock_step`): the time line goes on
///   after a pause.
///
/// Memory: two times kSortedRows rows, taken at once. Throws Error where the clock steps in more
/// than one row of fifty, or stamps stray in as many, and where rows of several time lines take
/// turns (StampsInTurn).
class OrderedRows : public RowSource {
 public:
  /// @param name  of the recording, for messages
  OrderedRows(std::unique_ptr<RowSource> rows, std::string name);

  [[nodiscard]] const Columns& columns() const override { return rows_.source().columns(); }
  [[nodiscard]] bool next(Row& row) override;
  [[nodiscard]] std::uint64_t line() const override { return line_; }
  [[nodiscard]] std::optional<double> fraction_read() const override {
    return rows_.source().fraction_read();
  }
  [[nodiscard]] std::vector<std::string> ignored_columns() const override {
    return rows_.source().ignored_columns();
  }
  [[nodiscard]] LeftOut left_out() const override;

 private:
  void fill();
  /// Throws Error where rows take turns.
  void expect_one_time_line(const NumberedRow& row);
  void judge_next();
  void judge_backwards();
  [[nodiscard]] bool is_wrap();
  /// Range of the counter that began again between a time and the judged row, if one did.
  [[nodiscard]] std::optional<std::int64_t> range_of_wrap(std::int64_t latest_ns) const;
  /// Stamp on the time line; the end of 64 bits where it lies beyond.
  [[nodiscard]] std::int64_t on_time_line(const Row& row) const;
  [[nodiscard]] std::int64_t earliest_until(std::size_t end) const;
  /// End of the rows from the judged ones on that lie before the latest stamp.
  [[nodiscard]] std::size_t end_of_late() const;
  /// First judged row that is later than this.
  [[nodiscard]] std::size_t first_later(std::int64_t time_ns) const;
  /// Number of the judged rows from a place on that are not later than this.
  [[nodiscard]] std::size_t rows_until(std::int64_t time_ns, std::size_t first) const;
  [[nodiscard]] bool fills_a_hole(std::size_t later, std::size_t end) const;
  [[nodiscard]] bool counts_again(std::size_t later, std::size_t end) const;
  [[nodiscard]] bool leave_out_stray(std::size_t later, std::size_t end);
  void leave_out(std::size_t first, std::size_t end);
  void sort(std::size_t later, std::size_t end);
  void step_clock();
  /// Counts rows whose stamps go astray. Throws Error where they are too many.
  void count_disorder(std::uint64_t line, std::uint64_t more, std::uint64_t& count);
  void measure_period();
  [[nodiscard]] bool continues(std::int64_t from_ns, std::int64_t to_ns, std::size_t rows) const;

  RowsAhead rows_;
  std::string name_;
  std::vector<NumberedRow> ahead_;    ///< judged rows that may still move, then those to be judged
  std::size_t begin_ = 0;             ///< next row to be given
  std::size_t judged_ = 0;            ///< end of the judged rows
  std::int64_t offset_ns_ = 0;        ///< from stamps to the time line
  std::int64_t latest_ns_ = 0;        ///< stamp of the latest judged row
  std::int64_t given_ns_ = 0;         ///< time of the row given last
  std::int64_t period_ns_ = 0;        ///< mean interval of the rows around, gaps left out
  std::int64_t longest_step_ns_ = 0;  ///< gaps are longer steps from stamp to stamp
  std::uint64_t given_ = 0;
  std::uint64_t steps_ = 0;
  std::uint64_t measured_at_ = 0;  ///< number of the row at which the period was measured
  std::uint64_t line_ = 0;
  StampsInTurn turns_;
  LeftOut left_out_;
};

}  // namespace zerorate::recording
