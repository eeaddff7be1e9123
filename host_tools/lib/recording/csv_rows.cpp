#include "host_tools/lib/recording/csv_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "core/base/time.hpp"
#include "host_tools/lib/recording/number.hpp"

namespace zerorate::recording {
namespace {

bool is_blank(std::string_view line) {
  return line.find_first_not_of(" \t") == std::string_view::npos;
}

}  // namespace

CsvRows::CsvRows(const std::filesystem::path& path, const Layout& layout, Needs needs)
    : lines_(path),
      header_(read_header(lines_, layout, needs)),
      decimal_comma_(header_.decimal_comma) {
  if (decimal_comma_ && header_.delimiter == ',') {
    throw Error{lines_.place(), "commas between the fields",
                "another delimiter beside decimal commas", "Name it: --delimiter ';'."};
  }
}

std::vector<std::string> CsvRows::ignored_columns() const {
  std::vector<std::string> names;
  for (const Column& column : header_.layout) {
    if (column.meaning == Meaning::ignored) {
      names.push_back(column.name);
    }
  }
  return names;
}

bool CsvRows::next_line(std::string_view& line) {
  if (!std::exchange(is_first_line_, false) || header_.first_row.empty()) return lines_.next(line);
  line = header_.first_row;
  return true;
}

bool CsvRows::next(Row& row) {
  while (true) {
    std::string_view line;
    if (!next_line(line) || is_blank(line)) {
      expect_no_more_rows();
      return false;
    }
    if (line == header_.line && header_.first_row.empty()) continue;  // a logger that began again
    if (rows_ == 0 && is_row_of_units(line)) continue;
    if (is_damaged_end(line)) return false;
    Row parsed;
    if (!parse(line, parsed)) continue;
    if (!lines_.is_terminated()) parsed.findings.add(Finding::line_unterminated);
    if (header_.has_ticks) parsed.odometer_pulses = count_ticks();
    ++rows_;
    row = parsed;
    return true;
  }
}

/// A row below the names that has texts, such as units, instead of all numbers of times and rates.
bool CsvRows::is_row_of_units(std::string_view line) {
  Fields fields{line, header_.delimiter};
  std::size_t texts = 0;
  for (const Column& column : header_.layout) {
    if (!fields.next()) return false;
    const std::string_view text = fields.text();
    if (column.meaning != Meaning::time && column.meaning != Meaning::rate) continue;
    if (column.unit.is_calendar ? parse_calendar_time(text).has_value()
                                : !text.empty() && parse_real(with_point(text)).has_value())
      return false;
    if (column.meaning == Meaning::rate && text.empty()) return false;
    texts += text.empty() ? 0U : 1U;
  }
  return texts > 0;
}

/// A last line that was cut off, or bytes that were never written: what is whole before it counts.
bool CsvRows::is_damaged_end(std::string_view line) {
  if (lines_.is_terminated() || rows_ == 0) return false;
  std::size_t fields = 0;
  for (Fields each{line, header_.delimiter}; each.next();) ++fields;
  if (fields >= header_.layout.size() && line.find('\0') == std::string_view::npos) return false;
  left_out_.damaged = 1;
  left_out_.damaged_line = lines_.line();
  return true;
}

void CsvRows::expect_no_more_rows() {
  const std::uint64_t first_empty = lines_.line();
  std::string_view line;
  while (lines_.next(line)) {
    if (!is_blank(line)) {
      throw Error{{lines_.place().file, first_empty},
                  "an empty line between the samples",
                  "one sample a line",
                  "Remove the line."};
    }
  }
  if (rows_ == 0) {
    throw Error{lines_.place(), "a header but no samples", "at least one sample after the header",
                "Check that the recording was written to its end."};
  }
}

bool CsvRows::parse(std::string_view line, Row& row) {
  Fields fields{line, header_.delimiter};
  for (const Column& column : header_.layout) {
    if (!fields.next()) {
      throw bad_field_count(line);
    }
    if (column.wanted && fields.text() != *column.wanted) return false;
    parse_field(column, fields, row);
  }
  if (fields.next()) {
    throw bad_field_count(line);
  }
  return true;
}

void CsvRows::parse_field(const Column& column, const Fields& fields, Row& row) {
  switch (column.meaning) {
    case Meaning::time:
      row.time_ns += parse_time(column, fields);
      break;
    case Meaning::nanoseconds:
      row.time_ns += parse_part_of_second(column, fields, "nanoseconds", 1'000'000'000);
      break;
    case Meaning::microseconds:
      row.time_ns += 1'000 * parse_part_of_second(column, fields, "microseconds", 1'000'000);
      break;
    case Meaning::rate:
      row.rate_rad_s[column.axis] = parse_measured(column, fields);
      break;
    case Meaning::temperature:
      row.temperature_degc = parse_measured(column, fields);
      break;
    case Meaning::acceleration:
      row.acceleration_m_s2[column.axis] = parse_measured(column, fields);
      break;
    case Meaning::odometer:
      row.odometer_pulses = parse_count(column, fields);
      break;
    case Meaning::still:
      row.still = parse_still(column, fields);
      break;
    case Meaning::ticks:
      wheels_[column.axis].read = parse_count(column, fields);
      break;
    case Meaning::turn:
      row.turn_rad_s = parse_measured(column, fields);
      break;
    case Meaning::speed:
      row.speed_m_s = parse_measured(column, fields);
      break;
    case Meaning::ref_heading:
      row.ref_heading_rad = parse_measured(column, fields);
      break;
    case Meaning::ref_rate:
      row.ref_rate_rad_s = parse_measured(column, fields);
      break;
    case Meaning::ref_speed:
      row.ref_speed_m_s = parse_measured(column, fields);
      break;
    case Meaning::ignored:
      break;
  }
}

std::int64_t CsvRows::parse_time(const Column& column, const Fields& fields) {
  if (column.unit.is_calendar) {
    if (const auto time_ns = parse_calendar_time(fields.text())) return *time_ns;
    throw bad_field(column, fields, "a time such as 2026-03-01T12:30:00.25Z",
                    "A sample without a time cannot be placed: repair or remove the row.");
  }
  const auto time = parse_fixed_point(with_point(fields.text()), column.unit.decimals);
  if (!time || !core::is_in_range(core::Instant::from_ns(time->value))) {
    throw bad_field(column, fields,
                    "a time in seconds, from -2305843009 to 4611686018, or in the unit of --units",
                    "A sample without a time cannot be placed: repair or remove the row; another "
                    "unit is named by --columns t=NAME --units time=ns.");
  }
  return time->value;
}

std::int64_t CsvRows::parse_part_of_second(const Column& column, const Fields& fields,
                                           std::string_view name, std::int64_t of_a_second) const {
  const auto part = parse_fixed_point(fields.text(), 0);
  if (!part || !part->exact || part->value < 0 || part->value >= of_a_second) {
    throw bad_field(column, fields, fmt::format("{} of a second, 0 to {}", name, of_a_second - 1),
                    "The seconds stand in the column of t.");
  }
  return part->value;
}

std::int64_t CsvRows::parse_count(const Column& column, const Fields& fields) const {
  const auto count = parse_fixed_point(fields.text(), 0);
  if (!count || !count->exact) {
    throw bad_field(column, fields, "a whole number, the pulses counted so far",
                    "Repeat the last count where no pulse arrived.");
  }
  return count->value;
}

bool CsvRows::parse_still(const Column& column, const Fields& fields) const {
  const auto still = parse_fixed_point(fields.text(), 0);
  if (!still || !still->exact || (still->value != 0 && still->value != 1)) {
    throw bad_field(column, fields, "1 (still) or 0 (moving)",
                    "Write 0 where it is not known: such a sample is never calibrated on.");
  }
  return still->value == 1;
}

/// Ticks of all wheels since the first row, forwards and backwards alike: wheels that turn against
/// each other do not cancel.
std::int64_t CsvRows::count_ticks() {
  for (Wheel& wheel : wheels_) {
    if (rows_ > 0) ticks_ += std::abs(wheel.read - wheel.counted);
    wheel.counted = wheel.read;
  }
  return ticks_;
}

float CsvRows::parse_measured(const Column& column, const Fields& fields) {
  const auto value = parse_real(with_point(fields.text()));
  if (!value) {
    throw bad_field(column, fields, "a number such as -0.25 or 1e-3",
                    "Leave the cell empty or write nan where the value was lost; decimals with a "
                    "comma are read with --decimal-comma.");
  }
  return to_si(*value - column.unit.zero, column.unit.si_per_unit);
}

std::string_view CsvRows::with_point(std::string_view text) {
  if (!decimal_comma_) return text;
  scratch_ = text;
  std::ranges::replace(scratch_, ',', '.');
  return scratch_;
}

Error CsvRows::bad_field(const Column& column, const Fields& fields, std::string expected,
                         std::string mend) const {
  return Error{lines_.place(fields.column()),
               fmt::format("{} as {}", excerpt(fields.text()), column.name), std::move(expected),
               std::move(mend)};
}

Error CsvRows::bad_field_count(std::string_view line) const {
  std::size_t count = 0;
  for (Fields fields{line, header_.delimiter}; fields.next();) {
    ++count;
  }
  const std::size_t expected = header_.layout.size();
  return Error{lines_.place(),
               fmt::format("{} field{} in {}", count, count == 1 ? "" : "s", excerpt(line)),
               fmt::format("{} as in the header", expected),
               count < expected ? "The line may have been cut off; repair or remove it."
                                : "Decimals are written with a point, not with a comma."};
}

}  // namespace zerorate::recording
