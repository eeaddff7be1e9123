/// @file
/// Angles since the row before, made rates.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_tools/lib/recording/row_source.hpp"
#include "host_tools/lib/recording/rows_ahead.hpp"

namespace zerorate::recording {

/// Divides the angle of a row by the time since the row before, or the first row's by that to the
/// next. Behind more than one and a half median intervals the angle may be of one sample or of all
/// the time: its rates are lost.
class RatesOfIncrements : public RowSource {
 public:
  /// @param rows  on one time line
  explicit RatesOfIncrements(std::unique_ptr<RowSource> rows);

  [[nodiscard]] const Columns& columns() const override { return columns_; }
  [[nodiscard]] bool next(Row& row) override;
  [[nodiscard]] std::uint64_t line() const override { return line_; }
  [[nodiscard]] std::optional<double> fraction_read() const override {
    return rows_.source().fraction_read();
  }
  [[nodiscard]] std::vector<std::string> ignored_columns() const override {
    return rows_.source().ignored_columns();
  }
  [[nodiscard]] LeftOut left_out() const override { return rows_.source().left_out(); }

 private:
  RowsAhead rows_;
  Columns columns_;
  NumberedRow ahead_;
  bool has_ahead_ = false;
  std::optional<std::int64_t> time_before_ns_;
  IntervalMedian intervals_;
  std::uint64_t line_ = 0;
};

}  // namespace zerorate::recording
