/// @file
/// Layout of a text file: which column holds which quantity, in which unit, and what separates
/// fields.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace zerorate::recording {

/// Meaning of a column of the file.
enum class Meaning : std::uint8_t {
  time,
  nanoseconds,
  microseconds,
  rate,
  temperature,
  acceleration,
  odometer,
  still,
  ticks,
  speed,
  turn,
  ref_heading,
  ref_rate,
  ref_speed,
  ignored
};

/// Dimension of a quantity: columns of one dimension share a unit in `--units`.
enum class Dimension : std::uint8_t { none, time, rate, temperature, acceleration, speed, angle };

/// Unit of a column. A measured value is (number - zero) * si_per_unit; a time is read exactly.
struct Unit {
  double si_per_unit = 1.0;
  double zero = 0.0;
  int decimals = 9;           ///< decimals of a time: its unit is 10^-9 s times 10^decimals
  bool is_increment = false;  ///< the value is an angle since the sample before
  bool is_calendar = false;   ///< calendar time: date and time of day by ISO 8601

  bool operator==(const Unit&) const = default;
};

/// A quantity that a column can hold.
struct Quantity {
  std::string_view key;  ///< key in `--columns key=NAME`
  Meaning meaning = Meaning::ignored;
  Dimension dimension = Dimension::none;
  std::size_t axis = 0;        ///< axis of a rate or an acceleration, wheel of ticks
  std::size_t axis_count = 0;  ///< columns that make the set
};

[[nodiscard]] std::span<const Quantity> quantities();
/// nullptr where no quantity has this key.
[[nodiscard]] const Quantity* find_quantity(std::string_view key);

/// Reads a unit of a dimension as users and files write it: "dps", "rad s^-1", "ms". A factor may
/// stand in front, for raw counts: "0.00875dps". nullopt for what is no such unit.
[[nodiscard]] std::optional<Unit> parse_unit(Dimension dimension, std::string_view text);
/// Names of the units of a dimension for messages: "s, ms, us, ns or iso".
[[nodiscard]] std::string_view unit_names(Dimension dimension);
/// Name of a dimension as in `--units`: "rate".
[[nodiscard]] std::string_view name(Dimension dimension);

/// The user's word on a file that does not describe itself.
struct Layout {
  char delimiter = '\0';       ///< between fields; '\0': the header line shows it
  bool decimal_comma = false;  ///< decimals are written with a comma: "0,5"
  /// Names of columns in the file by key; "#3" is the third column, also of a file without a
  /// header.
  std::map<std::string_view, std::string> columns;
  std::map<Dimension, Unit> units;  ///< units of columns whose names give none
  /// Text that a column must have, by its name or "#3": other rows are not of this recording.
  std::map<std::string, std::string> where;
  std::size_t skipped_lines = 0;     ///< lines before the header
  std::optional<double> rows_at_hz;  ///< rate of the rows, where the stamps do not count

  /// Takes "t=stamp,gx=wx" as typed. Throws std::invalid_argument.
  void set_columns(std::string_view text);
  /// Takes "id=0,topic=imu" as typed. Throws std::invalid_argument.
  void set_where(std::string_view text);
  /// Takes "time=ns,rate=radps" as typed. Throws std::invalid_argument.
  void set_units(std::string_view text);
  /// Takes ",", ";", "tab" or "space" as typed. Throws std::invalid_argument.
  void set_delimiter(std::string_view text);
};

}  // namespace zerorate::recording
