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
};

/// Opens a text file, a folder of EuRoC or a bag, joined with its odometer. Throws Error.
[[nodiscard]] std::unique_ptr<RowSource> open_rows(const Input& input);

}  // namespace zerorate::recording
