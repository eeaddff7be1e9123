#include "host_tools/lib/recording/header.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string_view>

#include "host_tools/lib/recording/fields.hpp"
#include "host_tools/lib/recording/number.hpp"

namespace zerorate::recording {
namespace {

struct AcceptedName {
  std::string_view name;
  Meaning meaning;
  RateUnit unit = RateUnit::deg_per_s;  ///< of a rate
  std::size_t axis = 0;                 ///< of a rate
  std::size_t axis_count = 0;           ///< of a rate: how many columns make the set
};

/// Accepted names of columns; of two with one meaning the first is the one that is written.
constexpr std::array kAcceptedNames = {
    AcceptedName{"t_s", Meaning::time},
    AcceptedName{"time_s", Meaning::time},
    AcceptedName{"gx_dps", Meaning::rate, RateUnit::deg_per_s, 0, 3},
    AcceptedName{"gy_dps", Meaning::rate, RateUnit::deg_per_s, 1, 3},
    AcceptedName{"gz_dps", Meaning::rate, RateUnit::deg_per_s, 2, 3},
    AcceptedName{"gx_radps", Meaning::rate, RateUnit::rad_per_s, 0, 3},
    AcceptedName{"gy_radps", Meaning::rate, RateUnit::rad_per_s, 1, 3},
    AcceptedName{"gz_radps", Meaning::rate, RateUnit::rad_per_s, 2, 3},
    AcceptedName{"rate_dps", Meaning::rate, RateUnit::deg_per_s, 0, 1},
    AcceptedName{"rate_radps", Meaning::rate, RateUnit::rad_per_s, 0, 1},
    AcceptedName{"temp_c", Meaning::temperature},
    AcceptedName{"temperature_c", Meaning::temperature},
    AcceptedName{"odometer_pulses", Meaning::odometer},
    AcceptedName{"still", Meaning::still},
    AcceptedName{"ref_heading_deg", Meaning::ref_heading},
    AcceptedName{"ref_rate_dps", Meaning::ref_rate},
    AcceptedName{"ref_speed_mps", Meaning::ref_speed},
};

constexpr std::string_view kRateNames =
    "gx_dps,gy_dps,gz_dps or rate_dps (deg/s), or gx_radps,gy_radps,gz_radps or rate_radps (rad/s)";

const AcceptedName* find_accepted(std::string_view name) {
  const auto* const found = std::find_if(kAcceptedNames.begin(), kAcceptedNames.end(),
                                         [&](const AcceptedName& a) { return a.name == name; });
  return found != kAcceptedNames.end() ? found : nullptr;
}

/// A column of the header line together with the entry of the table that it matched.
struct NamedColumn {
  std::string name;
  std::size_t position;  ///< character in the line, from 1
  const AcceptedName* accepted;
};

using NamedColumns = std::vector<NamedColumn>;

std::string all_names(const NamedColumns& columns) {
  std::vector<std::string_view> names;
  for (const NamedColumn& column : columns) {
    names.emplace_back(column.name);
  }
  return excerpt(fmt::format("{}", fmt::join(names, ",")));
}

bool begins_with(std::string_view name, std::string_view lower_case_stem) {
  return name.size() >= lower_case_stem.size() &&
         std::equal(
             lower_case_stem.begin(), lower_case_stem.end(), name.begin(),
             [](char stem, char c) { return stem == std::tolower(static_cast<unsigned char>(c)); });
}

/// The first column without a meaning whose name begins, in any case, with one of the stems.
const NamedColumn* find_near_miss(const NamedColumns& columns,
                                  std::initializer_list<std::string_view> stems) {
  for (const NamedColumn& column : columns) {
    for (const std::string_view stem : stems) {
      if (column.accepted == nullptr && begins_with(column.name, stem)) {
        return &column;
      }
    }
  }
  return nullptr;
}

Error missing(const LineReader& lines, const NamedColumns& columns, const NamedColumn* near_miss,
              std::string expected) {
  if (near_miss == nullptr) {
    return Error{lines.place(), "the columns " + all_names(columns), std::move(expected),
                 "Add the column, or rename the one that holds it."};
  }
  return Error{lines.place(near_miss->position), "the column name " + excerpt(near_miss->name),
               std::move(expected),
               "The name carries the unit: convert the column if need be, and rename it."};
}

/// Finds the column of a meaning, and refuses a second one.
const NamedColumn* find_single(const LineReader& lines, const NamedColumns& columns,
                               Meaning meaning) {
  const NamedColumn* found = nullptr;
  for (const NamedColumn& column : columns) {
    if (column.accepted == nullptr || column.accepted->meaning != meaning) {
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

/// Finds the set of rate columns: all of one unit, all axes, each once.
const AcceptedName& find_rates(const LineReader& lines, const NamedColumns& columns) {
  const NamedColumn* first = nullptr;
  std::array<const NamedColumn*, kMaxAxes> axes{};
  for (const NamedColumn& column : columns) {
    if (column.accepted == nullptr || column.accepted->meaning != Meaning::rate) {
      continue;
    }
    first = first != nullptr ? first : &column;
    const NamedColumn*& seen = axes[column.accepted->axis];
    if (seen != nullptr || column.accepted->unit != first->accepted->unit ||
        column.accepted->axis_count != first->accepted->axis_count) {
      throw Error{lines.place(column.position),
                  fmt::format("both {} and {}", seen ? seen->name : first->name, column.name),
                  "the rate once and in one unit", "Remove or rename one of the two."};
    }
    seen = &column;
  }
  if (first == nullptr) {
    throw missing(lines, columns, find_near_miss(columns, {"gx", "gy", "gz", "gyro", "rate"}),
                  fmt::format("gyro columns named {}", kRateNames));
  }
  for (std::size_t axis = 0; axis < first->accepted->axis_count; ++axis) {
    if (axes[axis] == nullptr) {
      throw Error{lines.place(), fmt::format("{} but not all three axes", first->name),
                  "x, y and z; or a single axis named rate_dps or rate_radps",
                  "Add the missing axis, or rename the only one."};
    }
  }
  return *first->accepted;
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

NamedColumns split(const LineReader& lines, std::string_view line) {
  refuse_binary(lines, line);
  NamedColumns columns;
  for (Fields fields{line}; fields.next();) {
    columns.push_back({std::string{fields.text()}, fields.column(), find_accepted(fields.text())});
  }
  if (parse_real(columns.front().name) && !columns.front().name.empty()) {
    throw Error{lines.place(), "numbers in the first line: " + excerpt(line),
                "a header line with the names of the columns",
                "Put a line such as t_s,gx_dps,gy_dps,gz_dps in front."};
  }
  if (columns.size() == 1 && line.find_first_of(";\t") != std::string_view::npos) {
    throw Error{lines.place(line.find_first_of(";\t") + 1),
                "fields separated by semicolons or tabs: " + excerpt(line),
                "fields separated by commas", "Export with commas, and points in the decimals."};
  }
  return columns;
}

/// Moves to the header line, past comments and empty lines.
std::string_view find_header_line(LineReader& lines) {
  std::string_view line;
  while (lines.next(line)) {
    if (!line.empty() && !line.starts_with('#')) {
      return line;
    }
  }
  throw Error{lines.place(), lines.line() == 0 ? "an empty file" : "only comments and empty lines",
              "a header line and samples", "Check that this is the right file."};
}

}  // namespace

Header read_header(LineReader& lines) {
  const NamedColumns named = split(lines, find_header_line(lines));
  if (find_single(lines, named, Meaning::time) == nullptr) {
    throw missing(lines, named, find_near_miss(named, {"t_", "time", "stamp"}),
                  "a time column named t_s or time_s (seconds)");
  }
  const AcceptedName& rates = find_rates(lines, named);
  Header header;
  header.columns.axis_count = rates.axis_count;
  header.columns.rate_unit = rates.unit;
  const auto has = [&](Meaning meaning) { return find_single(lines, named, meaning) != nullptr; };
  header.columns.temperature = has(Meaning::temperature);
  header.columns.odometer = has(Meaning::odometer);
  header.columns.still = has(Meaning::still);
  header.columns.ref_heading = has(Meaning::ref_heading);
  header.columns.ref_rate = has(Meaning::ref_rate);
  header.columns.ref_speed = has(Meaning::ref_speed);
  for (const NamedColumn& column : named) {
    const AcceptedName* const accepted = column.accepted;
    header.layout.push_back(accepted != nullptr
                                ? Column{column.name, accepted->meaning, accepted->axis}
                                : Column{column.name});
  }
  return header;
}

std::string header_line(const Columns& columns) {
  std::string line = "t_s";
  for (const AcceptedName& accepted : kAcceptedNames) {
    if (accepted.meaning == Meaning::rate && accepted.unit == columns.rate_unit &&
        accepted.axis_count == columns.axis_count) {
      line.append(",").append(accepted.name);
    }
  }
  line += columns.temperature ? ",temp_c" : "";
  line += columns.odometer ? ",odometer_pulses" : "";
  line += columns.still ? ",still" : "";
  line += columns.ref_heading ? ",ref_heading_deg" : "";
  line += columns.ref_rate ? ",ref_rate_dps" : "";
  line += columns.ref_speed ? ",ref_speed_mps" : "";
  return line;
}

}  // namespace zerorate::recording
