/// @file
/// A source that is read ahead of the row that is given.
#pragma once

#include <exception>
#include <memory>
#include <utility>

#include "host_tools/lib/recording/row_source.hpp"

namespace zerorate::recording {

/// Reads rows with their lines, and keeps an error of the source until the rows before it are
/// given.
class RowsAhead {
 public:
  explicit RowsAhead(std::unique_ptr<RowSource> rows) : rows_(std::move(rows)) {}

  [[nodiscard]] const RowSource& source() const { return *rows_; }
  /// False at the end and where the source failed.
  [[nodiscard]] bool next(NumberedRow& row) {
    if (is_at_end_) return false;
    try {
      is_at_end_ = !rows_->next(row.row);
    } catch (...) {
      error_ = std::current_exception();
      is_at_end_ = true;
    }
    row.line = rows_->line();
    return !is_at_end_;
  }
  [[nodiscard]] bool is_at_end() const { return is_at_end_; }
  /// Throws what the source threw, once.
  void rethrow() {
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  }

 private:
  std::unique_ptr<RowSource> rows_;
  std::exception_ptr error_;
  bool is_at_end_ = false;
};

}  // namespace zerorate::recording
