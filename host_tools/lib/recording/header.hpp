/// @file
/// The header line: names of columns to what they mean.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host_tools/lib/recording/line_reader.hpp"
#include "host_tools/lib/recording/row.hpp"

namespace zerorate::recording {

/// Meaning of a column of the file.
enum class Meaning : std::uint8_t {
  time,
  rate,
  temperature,
  odometer,
  still,
  ref_heading,
  ref_rate,
  ref_speed,
  ignored
};

/// One column of the file.
struct Column {
  std::string name;
  Meaning meaning = Meaning::ignored;
  std::size_t axis = 0;  ///< of a rate: its index in Row::rate_rad_s
};

/// The header of a recording.
struct Header {
  std::vector<Column> layout;  ///< all columns, in the order of the file
  Columns columns;
};

/// Reads the lines up to and including the header. Lines before it may be empty or comments (#).
/// Throws Error if the file is empty, is no CSV, or lacks or doubles a column.
[[nodiscard]] Header read_header(LineReader& lines);

/// The header line that Writer puts out for these columns, without a line end.
[[nodiscard]] std::string header_line(const Columns& columns);

}  // namespace zerorate::recording
