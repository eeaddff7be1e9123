/// @file
/// The streaming reader of recordings.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/fields.hpp"
#include "host_tools/lib/recording/findings.hpp"
#include "host_tools/lib/recording/header.hpp"
#include "host_tools/lib/recording/line_reader.hpp"
#include "host_tools/lib/recording/row.hpp"

namespace zerorate::recording {

/// Reads a recording row by row, once, in constant memory whatever its length:
///
///     Reader reader{"run.csv.gz"};
///     for (Row row; reader.next(row);) { ... }
///
/// The format is described in docs/reference/recording-format.md. What cannot be understood throws
/// Error with file, line and character; what can be understood but is odd (a lost rate, time
/// running backwards, a gap) is delivered as it stands, flagged in Row::findings and counted.
class Reader {
 public:
  /// Opens the file and reads its header. "-" is standard input. Throws Error.
  explicit Reader(const std::filesystem::path& path);

  [[nodiscard]] const Columns& columns() const { return header_.columns; }
  /// Names of the columns that are not read, in the order of the file.
  [[nodiscard]] std::vector<std::string> ignored_columns() const;

  /// Reads the next row; false at the end of the file, with `row` as it was. Throws Error, also at
  /// the end of a file without any row. After an Error the reader is not to be used further.
  [[nodiscard]] bool next(Row& row);

  /// The line of the row last read, from 1.
  [[nodiscard]] std::uint64_t line() const { return lines_.line(); }
  /// The share of the file's bytes on the disk already taken, 0 to 1; nullopt for a pipe.
  [[nodiscard]] std::optional<double> fraction_read() const { return lines_.fraction_read(); }
  /// The findings of the rows read so far.
  [[nodiscard]] const Findings& findings() const { return findings_; }

 private:
  void parse(std::string_view line, Row& row) const;
  void parse_field(const Column& column, const Fields& fields, Row& row) const;
  void expect_no_more_rows();
  [[nodiscard]] std::int64_t parse_time(const Column& column, const Fields& fields) const;
  [[nodiscard]] std::int64_t parse_count(const Column& column, const Fields& fields) const;
  [[nodiscard]] bool parse_still(const Column& column, const Fields& fields) const;
  [[nodiscard]] double parse_measured(const Column& column, const Fields& fields) const;
  [[nodiscard]] Error bad_field(const Column& column, const Fields& fields, std::string expected,
                                std::string mend) const;
  [[nodiscard]] Error bad_field_count(std::string_view line) const;

  LineReader lines_;
  Header header_;
  Findings findings_;
};

}  // namespace zerorate::recording
