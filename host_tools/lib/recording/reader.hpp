/// @file
/// The streaming reader of recordings.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/findings.hpp"
#include "host_tools/lib/recording/row_source.hpp"

namespace zerorate::recording {

/// Reads a recording row by row, once, in constant memory whatever its length:
///
///     Reader reader{"run.csv.gz"};
///     for (Row row; reader.next(row);) { ... }
///
/// The format is described in docs/reference/recording-format.md; Input says where a file departs
/// from it. What cannot be understood throws Error with file, line and character; what can be
/// understood but is odd (a lost rate, a gap) is delivered as it stands, flagged in Row::findings
/// and counted. Times never run backwards: OrderedRows and SpreadRows put them on one time line.
class Reader {
 public:
  /// Opens the input and reads its header. Throws Error.
  explicit Reader(const Input& input) : rows_(open_rows(input)) {}
  /// Reads from a source that is already open.
  /// @param name  of the recording, for messages
  Reader(std::unique_ptr<RowSource> rows, const std::string& name)
      : rows_(on_one_time_line(std::move(rows), name)) {}

  [[nodiscard]] const Columns& columns() const { return rows_->columns(); }
  /// Names of the columns that are not read, in the order of the file.
  [[nodiscard]] std::vector<std::string> ignored_columns() const {
    return rows_->ignored_columns();
  }

  /// Reads the next row; false at the end of the file, with `row` as it was. Throws Error, also at
  /// the end of a file without any row; DataError where more than half of the rows were left out.
  /// After an Error the reader is not to be used further.
  [[nodiscard]] bool next(Row& row) {
    if (!rows_->next(row)) {
      findings_.add_left_out(rows_->left_out());
      require_most_rows(findings_);
      return false;
    }
    findings_.examine(row, rows_->columns(), rows_->line());
    return true;
  }

  /// The line of the row last read, from 1.
  [[nodiscard]] std::uint64_t line() const { return rows_->line(); }
  /// The share of the file's bytes on the disk already taken, 0 to 1; nullopt for a pipe.
  [[nodiscard]] std::optional<double> fraction_read() const { return rows_->fraction_read(); }
  /// The findings of the rows read so far.
  [[nodiscard]] const Findings& findings() const { return findings_; }

 private:
  std::unique_ptr<RowSource> rows_;
  Findings findings_;
};

}  // namespace zerorate::recording
