#include "host_tools/lib/recording/header.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "host_tools/lib/recording/column_names.hpp"
#include "host_tools/lib/recording/exports.hpp"
#include "host_tools/lib/recording/fields.hpp"
#include "host_tools/lib/recording/number.hpp"

namespace zerorate::recording {
namespace {

constexpr std::string_view kRateNames =
    "gx_dps,gy_dps,gz_dps or rate_dps (deg/s), or gx_radps,gy_radps,gz_radps or rate_radps (rad/s)";
constexpr std::string_view kNameRates =
    "Name the columns and their unit: --columns gx=NAME,gy=NAME,gz=NAME --units rate=radps.";
constexpr std::string_view kNameTime =
    "Name the column and its unit: --columns t=NAME --units time=ms. Without one, --rows-at HZ "
    "gives the rate of the rows.";
constexpr std::string_view kNameMotion =
    "Name the column: --odometer-columns t=NAME,speed=NAME --odometer-units speed=kmh.";

/// A column of the header line, and what it was taken for.
struct NamedColumn {
  std::string name;
  std::size_t position = 0;            ///< character in the line, from 1
  const Quantity* quantity = nullptr;  ///< nullptr: not needed
  std::optional<Unit> unit = {};       ///< unit of a quantity with a dimension
};

using NamedColumns = std::vector<NamedColumn>;

/// Gives columns their meaning: by the user's word, else by their names.
class ColumnNaming {
 public:
  ColumnNaming(const LineReader& lines, const Layout& layout) : lines_(lines), layout_(layout) {}

  void name(NamedColumn& column, std::size_t index) {
    column.quantity = by_word(column.name, index);
    const bool is_said = column.quantity != nullptr;
    if (!is_said) {
      column.quantity = quantity_in_name(column.name);
      if (column.quantity != nullptr && is_said_elsewhere(*column.quantity))
        column.quantity = nullptr;
    }
    if (column.quantity == nullptr || column.quantity->dimension == Dimension::none) return;
    const Dimension dimension = column.quantity->dimension;
    const auto said = layout_.units.find(dimension);
    column.unit = unit_in_name(dimension, column.name);
    if (said != layout_.units.end() && (is_said || !column.unit)) {
      column.unit = said->second;
      used_.push_back(dimension);
    }
    if (column.unit) return;
    throw Error{lines_.place(column.position), "no unit in the name " + excerpt(column.name),
                fmt::format("{}", unit_names(dimension)),
                fmt::format("Say the unit: --units {}=...", recording::name(dimension))};
  }

  /// Advice where a name of --columns is not in the header.
  static std::string cure_of_names(const NamedColumns& columns) {
    const std::string cure = "Names count as they stand in the header; #3 is the third column.";
    return cure + (columns.size() > 1 ? "" : " There is only one: --delimiter space parts it.");
  }

  /// Refuses options that match no column.
  void check(const NamedColumns& columns) const {
    for (const auto& [key, name] : layout_.columns) {
      const Quantity* const said = find_quantity(key);
      const bool is_found = std::ranges::any_of(
          columns, [&](const NamedColumn& column) { return column.quantity == said; });
      if (is_found) continue;
      throw Error{lines_.place(), "no column " + excerpt(name),
                  fmt::format("the column of {} named in --columns", key), cure_of_names(columns)};
    }
    for (const auto& [dimension, unit] : layout_.units) {
      if (std::ranges::find(used_, dimension) != used_.end()) continue;
      throw Error{lines_.place(),
                  fmt::format("no column that needs --units {}=...", recording::name(dimension)),
                  "units in names (gx_dps), or columns named in --columns",
                  "Leave the unit out, or name the column."};
    }
  }

 private:
  [[nodiscard]] const Quantity* by_word(std::string_view name, std::size_t index) const {
    for (const auto& [key, said] : layout_.columns) {
      if (said == name || said == fmt::format("#{}", index + 1)) return find_quantity(key);
    }
    return nullptr;
  }

  [[nodiscard]] bool is_said_elsewhere(const Quantity& quantity) const {
    return std::ranges::any_of(layout_.columns, [&](const auto& said) {
      return find_quantity(said.first)->meaning == quantity.meaning;
    });
  }

  const LineReader& lines_;
  const Layout& layout_;
  std::vector<Dimension> used_;
};

std::string all_names(const NamedColumns& columns) {
  std::vector<std::string_view> names;
  for (const NamedColumn& column : columns) {
    names.emplace_back(column.name);
  }
  return excerpt(fmt::format("{}", fmt::join(names, ",")));
}

/// Tells of a missing column: at the one without a meaning whose name begins, in any case, with one
/// of the stems, else at the line.
Error missing(const LineReader& lines, const NamedColumns& columns,
              std::initializer_list<std::string_view> stems, std::string expected,
              std::string_view mend) {
  for (const NamedColumn& column : columns) {
    const bool is_near = std::ranges::any_of(
        stems, [&](std::string_view stem) { return begins_with(column.name, stem); });
    if (column.quantity != nullptr || !is_near) continue;
    return Error{lines.place(column.position), "the column name " + excerpt(column.name),
                 std::move(expected), std::string(mend)};
  }
  return Error{lines.place(), "the columns " + all_names(columns), std::move(expected),
               std::string(mend)};
}

/// Finds the column of a meaning, and refuses a second one.
const NamedColumn* find_single(const LineReader& lines, const NamedColumns& columns,
                               Meaning meaning) {
  const NamedColumn* found = nullptr;
  for (const NamedColumn& column : columns) {
    if (column.quantity == nullptr || column.quantity->meaning != meaning) {
      continue;
    }
    if (found != nullptr) {
      throw Error{lines.place(column.position),
                  fmt::format("both {} and {}", found->name, column.name), "only one of them",
                  "Remove or rename one of the two."};
    }
    found = &column;
  }
  return found;
}

/// Words of the errors about a set of columns, one an axis.
struct AxesWords {
  std::string_view once;      ///< quantity that is expected once
  std::string_view all_axes;  ///< axes that are expected
  std::string_view cure;      ///< for a missing axis
};

/// Finds the first of a set of columns: all of one unit, all axes, each once; nullptr for none.
const NamedColumn* find_axes(const LineReader& lines, const NamedColumns& columns, Meaning meaning,
                             const AxesWords& words) {
  const NamedColumn* first = nullptr;
  std::array<const NamedColumn*, kMaxAxes> axes{};
  for (const NamedColumn& column : columns) {
    if (column.quantity == nullptr || column.quantity->meaning != meaning) {
      continue;
    }
    first = first != nullptr ? first : &column;
    const NamedColumn*& seen = axes[column.quantity->axis];
    if (seen != nullptr || column.unit != first->unit ||
        column.quantity->axis_count != first->quantity->axis_count) {
      throw Error{lines.place(column.position),
                  fmt::format("both {} and {}", seen ? seen->name : first->name, column.name),
                  fmt::format("the {} once and in one unit", words.once),
                  "Remove or rename one of the two."};
    }
    seen = &column;
  }
  if (first == nullptr) return nullptr;
  for (std::size_t axis = 0; axis < first->quantity->axis_count; ++axis) {
    if (axes[axis] == nullptr) {
      throw Error{lines.place(), fmt::format("{} but not all three axes", first->name),
                  std::string(words.all_axes), std::string(words.cure)};
    }
  }
  return first;
}

const NamedColumn& find_rates(const LineReader& lines, const NamedColumns& columns) {
  constexpr AxesWords kWords{
      .once = "rate",
      .all_axes = "x, y and z; or a single axis named rate_dps or rate_radps",
      .cure = "Add the missing axis, or call the only one the rate: --columns rate=NAME."};
  if (const NamedColumn* const first = find_axes(lines, columns, Meaning::rate, kWords))
    return *first;
  throw missing(lines, columns, {"gx", "gy", "gz", "gyro", "rate"},
                fmt::format("gyro columns named {}", kRateNames), kNameRates);
}

bool has_accelerations(const LineReader& lines, const NamedColumns& columns) {
  constexpr AxesWords kWords{.once = "acceleration",
                             .all_axes = "the acceleration along x, y and z, or none of them",
                             .cure = "Add the missing axis, or rename the column."};
  return find_axes(lines, columns, Meaning::acceleration, kWords) != nullptr;
}

/// A single axis of three that is there alone makes a recording of one axis.
void take_single_axis(NamedColumns& columns) {
  NamedColumn* only = nullptr;
  for (NamedColumn& column : columns) {
    if (column.quantity == nullptr || column.quantity->meaning != Meaning::rate) continue;
    if (only != nullptr) return;
    only = &column;
  }
  if (only != nullptr) only->quantity = find_quantity("rate");
}

/// Texts that the user wants in columns.
void take_wanted(const LineReader& lines, const Layout& layout, Header& header) {
  for (const auto& wanted : layout.where) {
    const std::string& name = wanted.first;
    const auto found = std::ranges::find_if(header.layout, [&](const Column& column) {
      return column.name == name || name == fmt::format("#{}", &column - header.layout.data() + 1);
    });
    if (found == header.layout.end()) {
      throw Error{lines.place(), "no column " + excerpt(name), "the column named in --where",
                  "Names count as they stand in the header; #3 is the third column."};
    }
    found->wanted = wanted.second;
  }
}

/// Accelerations count together only: where the names of a file give not all three, and its user
/// names none, their columns are not needed.
void leave_out_partial_accelerations(NamedColumns& columns, const Layout& layout) {
  std::array<bool, kMaxAxes> seen{};
  for (const NamedColumn& column : columns) {
    if (column.quantity == nullptr || column.quantity->meaning != Meaning::acceleration) continue;
    if (layout.columns.contains(column.quantity->key)) return;
    seen[column.quantity->axis] = true;
  }
  if (seen == std::array{true, true, true}) return;
  for (NamedColumn& column : columns) {
    if (column.quantity != nullptr && column.quantity->meaning == Meaning::acceleration)
      column.quantity = nullptr;
  }
}

void refuse_binary(const LineReader& lines, std::string_view line) {
  const auto* const control = std::find_if(line.begin(), line.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 && c != '\t';
  });
  if (control != line.end()) {
    throw Error{lines.place(static_cast<std::uint64_t>(control - line.begin()) + 1),
                "binary data " + excerpt(line), "a CSV or CSV.gz file in UTF-8",
                "Export the recording as CSV; other archives than gzip are to be unpacked first."};
  }
}

NamedColumns split(std::string_view line, char delimiter) {
  NamedColumns columns;
  for (Fields fields{line, delimiter}; fields.next();) {
    columns.push_back({.name = std::string{fields.text()}, .position = fields.column()});
  }
  return columns;
}

bool holds_numbers(const NamedColumns& columns) {
  return !columns.front().name.empty() && parse_real(columns.front().name).has_value();
}

/// Whether a comment names a time and a rate together with their units.
bool is_header(std::string_view comment) {
  const NamedColumns columns = split(comment, delimiter_in(comment));
  const auto names = [&](Meaning meaning) {
    return std::ranges::any_of(columns, [&](const NamedColumn& column) {
      const Quantity* const quantity = quantity_in_name(column.name);
      return quantity != nullptr && quantity->meaning == meaning;
    });
  };
  return names(Meaning::time) && names(Meaning::rate);
}

/// Moves to the header line, past comments, empty lines and the delimiter as spreadsheets name it.
std::string_view find_header_line(LineReader& lines) {
  std::string_view line;
  while (lines.next(line)) {
    if (line.starts_with("#ROSBAG V")) {
      throw Error{lines.place(), "the bytes of a bag of ROS 1", "a CSV or CSV.gz file",
                  "Give its path to zerorate of the host tools, which opens it by itself."};
    }
    if (line.starts_with('#') && is_header(line.substr(1))) return line.substr(1);
    if (!line.empty() && !line.starts_with('#') && !line.starts_with("sep=")) return line;
  }
  throw Error{lines.place(), lines.line() == 0 ? "an empty file" : "only comments and empty lines",
              "a header line and samples", "Check that this is the right file."};
}

/// Names of columns may be numbers of columns: then the file needs no header.
bool may_lack_header(const Layout& layout) {
  return !layout.columns.empty() && std::ranges::all_of(layout.columns, [](const auto& column) {
    return column.second.starts_with('#');
  });
}

bool has_ticks(const NamedColumns& columns) {
  return std::ranges::any_of(columns, [](const NamedColumn& column) {
    return column.quantity != nullptr && column.quantity->meaning == Meaning::ticks;
  });
}

/// Refuses a rate of turn that tells nothing about rest.
void check_turn(const LineReader& lines, const NamedColumn* turn, bool has_speed) {
  if (turn == nullptr || (has_speed && !turn->unit->is_increment)) return;
  throw Error{lines.place(turn->position),
              fmt::format("{} as the rate of turn {}", turn->name,
                          has_speed ? "in an angle a sample" : "without a speed"),
              "a rate of turn in dps, radps or dph beside a speed",
              "Name both: --columns speed=NAME,turn=NAME --units speed=mps,rate=radps."};
}

Columns columns_of(const LineReader& lines, const NamedColumns& named, const Layout& layout,
                   Needs needs) {
  if (find_single(lines, named, Meaning::time) == nullptr && !layout.rows_at_hz) {
    throw missing(lines, named, {"t_", "time", "stamp"},
                  "a time column named t_s or time_s (seconds)", kNameTime);
  }
  Columns columns;
  const auto has = [&](Meaning meaning) { return find_single(lines, named, meaning) != nullptr; };
  columns.odometer = has(Meaning::odometer) || has_ticks(named);
  if (has(Meaning::odometer) && has_ticks(named)) {
    throw Error{lines.place(), "both pulses and ticks of wheels", "only one of them",
                "Leave pulses or ticks1 to ticks4 out of --columns."};
  }
  columns.still = has(Meaning::still);
  columns.speed = has(Meaning::speed);
  check_turn(lines, find_single(lines, named, Meaning::turn), columns.speed);
  if (needs == Needs::rates) {
    const NamedColumn& rates = find_rates(lines, named);
    columns.axis_count = rates.quantity->axis_count;
    columns.acceleration = has_accelerations(lines, named);
    const bool is_in_degrees = rates.unit == parse_unit(Dimension::rate, "dps");
    columns.are_increments = rates.unit->is_increment;
    columns.rate_unit = is_in_degrees ? RateUnit::deg_per_s : RateUnit::rad_per_s;
  } else if (!columns.odometer && !columns.still && !columns.speed) {
    throw missing(lines, named, {"speed", "v", "wheel", "odo", "ticks"},
                  "a column named odometer_pulses, still or speed_mps, or ticks of wheels",
                  kNameMotion);
  }
  columns.temperature = has(Meaning::temperature);
  columns.ref_heading = has(Meaning::ref_heading);
  columns.ref_rate = has(Meaning::ref_rate);
  columns.ref_speed = has(Meaning::ref_speed);
  return columns;
}

}  // namespace

Header read_header(LineReader& lines, const Layout& said, Needs needs) {
  const CompletedLayout completed = complete_layout(said, lines.ahead(), lines.place().file);
  const Layout& layout = completed.layout;
  std::string_view skipped;
  for (std::size_t k = 0; k < layout.skipped_lines && lines.next(skipped); ++k) {
  }
  const std::string_view line = find_header_line(lines);
  refuse_binary(lines, line);
  Header header{.line = std::string(line), .decimal_comma = layout.decimal_comma};
  header.delimiter = layout.delimiter != '\0' ? layout.delimiter : delimiter_in(line);
  NamedColumns named = split(line, header.delimiter);
  if (holds_numbers(named)) {
    if (!may_lack_header(layout)) {
      throw Error{lines.place(), "numbers in the first line: " + excerpt(line),
                  "a header line with the names of the columns",
                  "Say which column is which: --columns t=#1,gx=#2,gy=#3,gz=#4 --units "
                  "time=s,rate=dps."};
    }
    header.first_row = line;
  }
  ColumnNaming naming{lines, layout};
  for (std::size_t i = 0; i < named.size(); ++i) {
    if (!header.first_row.empty()) named[i].name = fmt::format("column {}", i + 1);
    naming.name(named[i], i);
  }
  naming.check(named);
  leave_out_partial_accelerations(named, layout);
  if (needs == Needs::rates) take_single_axis(named);
  header.columns = columns_of(lines, named, layout, needs);
  header.has_ticks = has_ticks(named);
  header.columns.program = completed.program;
  for (const NamedColumn& column : named) {
    const Quantity ignored;
    const Quantity& quantity = column.quantity != nullptr ? *column.quantity : ignored;
    header.layout.push_back(
        {column.name, quantity.meaning, quantity.axis, column.unit.value_or(Unit{}), std::nullopt});
  }
  take_wanted(lines, layout, header);
  return header;
}

}  // namespace zerorate::recording
