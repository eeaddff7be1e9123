/// @file
/// Rows of a text file, CSV or CSV.gz.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_tools/lib/recording/byte_source.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/fields.hpp"
#include "host_tools/lib/recording/header.hpp"
#include "host_tools/lib/recording/row_source.hpp"

namespace zerorate::recording {

/// Reads a text file row by row in constant memory. docs/reference/recording-format.md describes
/// the format; `layout` lists where a file departs from it.
class CsvRows : public RowSource {
 public:
  /// Opens the file and reads its header. "-" is standard input. Throws Error.
  CsvRows(const std::filesystem::path& path, const Layout& layout, Needs needs);

  [[nodiscard]] const Columns& columns() const override { return header_.columns; }
  [[nodiscard]] bool next(Row& row) override;
  [[nodiscard]] std::uint64_t line() const override { return lines_.line(); }
  [[nodiscard]] std::optional<double> fraction_read() const override {
    return lines_.fraction_read();
  }
  [[nodiscard]] std::vector<std::string> ignored_columns() const override;
  [[nodiscard]] LeftOut left_out() const override { return left_out_; }

 private:
  [[nodiscard]] bool next_line(std::string_view& line);
  /// False where the row is not of this recording (Layout::where).
  [[nodiscard]] bool parse(std::string_view line, Row& row);
  [[nodiscard]] bool is_row_of_units(std::string_view line);
  [[nodiscard]] bool is_damaged_end(std::string_view line);
  void parse_field(const Column& column, const Fields& fields, Row& row);
  void expect_no_more_rows();
  [[nodiscard]] std::int64_t parse_time(const Column& column, const Fields& fields);
  [[nodiscard]] std::int64_t parse_part_of_second(const Column& column, const Fields& fields,
                                                  std::string_view name,
                                                  std::int64_t of_a_second) const;
  [[nodiscard]] std::int64_t parse_count(const Column& column, const Fields& fields) const;
  [[nodiscard]] std::int64_t count_ticks();
  [[nodiscard]] bool parse_still(const Column& column, const Fields& fields) const;
  /// The measured value in SI units.
  [[nodiscard]] float parse_measured(const Column& column, const Fields& fields);
  /// The text of a number with a point for its decimals.
  [[nodiscard]] std::string_view with_point(std::string_view text);
  [[nodiscard]] Error bad_field(const Column& column, const Fields& fields, std::string expected,
                                std::string mend) const;
  [[nodiscard]] Error bad_field_count(std::string_view line) const;

  /// A counter of ticks.
  struct Wheel {
    std::int64_t read = 0;     ///< count in the newest row, also one that Layout::where leaves out
    std::int64_t counted = 0;  ///< count in the newest row of this recording
  };

  LineReader lines_;
  Header header_;
  bool decimal_comma_;
  std::string scratch_;
  std::array<Wheel, kMaxWheels> wheels_{};
  std::int64_t ticks_ = 0;
  std::uint64_t rows_ = 0;
  bool is_first_line_ = true;
  LeftOut left_out_;
};

}  // namespace zerorate::recording
