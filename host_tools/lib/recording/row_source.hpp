/// @file
/// Sources of rows: a text file, a bag, or one of them joined with an odometer's.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_tools/lib/recording/input.hpp"
#include "host_tools/lib/recording/row.hpp"

namespace zerorate::recording {

/// A row and its line in the file.
struct NumberedRow {
  Row row;
  std::uint64_t line = 0;
};

/// Rows that no measurement can be made of, because of their stamps.
struct LeftOut {
  std::uint64_t stray = 0;  ///< rows with a stamp far from those of their neighbours
  std::uint64_t first_stray_line = 0;
  std::uint64_t repeated = 0;  ///< copies of the row before, stamp and values
  std::uint64_t first_repeated_line = 0;
  std::uint64_t damaged = 0;  ///< lines at the end of a text file that are not whole
  std::uint64_t damaged_line = 0;

  [[nodiscard]] LeftOut operator+(const LeftOut& other) const {
    return {
        stray + other.stray,       stray > 0 ? first_stray_line : other.first_stray_line,
        repeated + other.repeated, repeated > 0 ? first_repeated_line : other.first_repeated_line,
        damaged + other.damaged,   damaged > 0 ? damaged_line : other.damaged_line};
  }
};

/// Gives the rows of one recording, once, in the order of the file.
class RowSource {
 public:
  virtual ~RowSource() = default;

  [[nodiscard]] virtual const Columns& columns() const = 0;
  /// Reads the next row; false at the end, with `row` as it was. Throws Error.
  [[nodiscard]] virtual bool next(Row& row) = 0;
  /// Line of the row that was given last, from 1; of a bag the number of its message.
  [[nodiscard]] virtual std::uint64_t line() const = 0;
  /// Share of the input that has been read, 0 to 1; nullopt for a pipe.
  [[nodiscard]] virtual std::optional<double> fraction_read() const = 0;
  /// Names of columns that are not read, in the order of the file.
  [[nodiscard]] virtual std::vector<std::string> ignored_columns() const { return {}; }
  /// Rows that were read so far and not given.
  [[nodiscard]] virtual LeftOut left_out() const { return {}; }
};

/// Puts the rows of a source on one time line: OrderedRows, then SpreadRows. Angles of rows become
/// rates there.
/// @param name  of the recording, for messages
/// @param rows_at_hz  rate of the rows, which then takes the place of their stamps
[[nodiscard]] std::unique_ptr<RowSource> on_one_time_line(std::unique_ptr<RowSource> rows,
                                                          const std::string& name,
                                                          std::optional<double> rows_at_hz = {});

/// Opens a text file, a folder of EuRoC or KITTI or a bag, joined with its odometer. Throws Error.
[[nodiscard]] std::unique_ptr<RowSource> open_rows(const Input& input);

}  // namespace zerorate::recording
