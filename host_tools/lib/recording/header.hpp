/// @file
/// The header line: names of columns to what they mean.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_tools/lib/recording/byte_source.hpp"
#include "host_tools/lib/recording/layout.hpp"
#include "host_tools/lib/recording/row.hpp"

namespace zerorate::recording {

/// One column of the file.
struct Column {
  std::string name;
  Meaning meaning = Meaning::ignored;
  std::size_t axis = 0;  ///< index in Row::rate_rad_s or Row::acceleration_m_s2; of a wheel
  Unit unit;
  std::optional<std::string> wanted;  ///< text of the rows that are read; nullopt: any
};

/// The header of a recording.
struct Header {
  std::vector<Column> layout;  ///< all columns, in the order of the file
  Columns columns;
  char delimiter = ',';
  std::string line;  ///< header line; a logger that began again wrote it once more
  bool decimal_comma = false;
  bool has_ticks = false;  ///< pulses are the ticks of wheels
  std::string first_row;   ///< the line that was read, where it holds numbers instead of names
};

/// Columns that a file must hold.
enum class Needs : std::uint8_t {
  rates,   ///< a recording of a gyro
  motion,  ///< pulses, still or speed of an odometer
};

/// Reads the lines up to and including the header. Lines before it may be empty or comments (#); a
/// comment that names time and rates with their units is the header (EuRoC). Lines before the
/// header of a known program are skipped (complete_layout). Throws Error if the file is empty, is
/// no CSV, or lacks or doubles a column.
[[nodiscard]] Header read_header(LineReader& lines, const Layout& layout, Needs needs);

}  // namespace zerorate::recording
