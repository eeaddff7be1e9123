#include "host_tools/lib/recording/reader.hpp"
#include "core/base/time.hpp"

#include <fmt/format.h>

#include <utility>

#include "host_tools/lib/recording/number.hpp"

namespace zerorate::recording {
namespace {

const double kRadPerDeg = rad_per_s_in(RateUnit::deg_per_s);

}  // namespace

Reader::Reader(const std::filesystem::path& path) : lines_(path), header_(read_header(lines_)) {}

std::vector<std::string> Reader::ignored_columns() const {
  std::vector<std::string> names;
  for (const Column& column : header_.layout) {
    if (column.meaning == Meaning::ignored) {
      names.push_back(column.name);
    }
  }
  return names;
}

bool Reader::next(Row& row) {
  std::string_view line;
  if (!lines_.next(line) || line.empty()) {
    expect_no_more_rows();
    return false;
  }
  Row parsed;
  parse(line, parsed);
  if (!lines_.is_terminated()) {
    parsed.findings.add(Finding::line_unterminated);
  }
  findings_.examine(parsed, header_.columns, lines_.line());
  row = parsed;
  return true;
}

void Reader::expect_no_more_rows() {
  const std::uint64_t first_empty = lines_.line();
  std::string_view line;
  while (lines_.next(line)) {
    if (!line.empty()) {
      throw Error{{lines_.place().file, first_empty},
                  "an empty line between the samples",
                  "one sample a line",
                  "Remove the line."};
    }
  }
  if (findings_.rows() == 0) {
    throw Error{lines_.place(), "a header but no samples", "at least one sample after the header",
                "Check that the recording was written to its end."};
  }
}

void Reader::parse(std::string_view line, Row& row) const {
  Fields fields{line};
  for (const Column& column : header_.layout) {
    if (!fields.next()) {
      throw bad_field_count(line);
    }
    parse_field(column, fields, row);
  }
  if (fields.next()) {
    throw bad_field_count(line);
  }
}

void Reader::parse_field(const Column& column, const Fields& fields, Row& row) const {
  switch (column.meaning) {
    case Meaning::time:
      row.time_ns = parse_time(column, fields);
      break;
    case Meaning::rate:
      row.rate_rad_s[column.axis] =
          to_si(parse_measured(column, fields), rad_per_s_in(header_.columns.rate_unit));
      break;
    case Meaning::temperature:
      row.temperature_degc = to_si(parse_measured(column, fields), 1.0);
      break;
    case Meaning::odometer:
      row.odometer_pulses = parse_count(column, fields);
      break;
    case Meaning::still:
      row.still = parse_still(column, fields);
      break;
    case Meaning::ref_heading:
      row.ref_heading_rad = to_si(parse_measured(column, fields), kRadPerDeg);
      break;
    case Meaning::ref_rate:
      row.ref_rate_rad_s = to_si(parse_measured(column, fields), kRadPerDeg);
      break;
    case Meaning::ref_speed:
      row.ref_speed_m_s = to_si(parse_measured(column, fields), 1.0);
      break;
    case Meaning::ignored:
      break;
  }
}

std::int64_t Reader::parse_time(const Column& column, const Fields& fields) const {
  constexpr int kNanosecondDecimals = 9;
  const auto time = parse_fixed_point(fields.text(), kNanosecondDecimals);
  if (!time || !core::is_in_range(core::Instant::from_ns(time->value))) {
    throw bad_field(column, fields, "a time in seconds, from -2305843009 to 4611686018",
                    "A sample without a time cannot be placed: repair or remove the row.");
  }
  return time->value;
}

std::int64_t Reader::parse_count(const Column& column, const Fields& fields) const {
  const auto count = parse_fixed_point(fields.text(), 0);
  if (!count || !count->exact) {
    throw bad_field(column, fields, "a whole number, the pulses counted so far",
                    "Repeat the last count where no pulse arrived.");
  }
  return count->value;
}

bool Reader::parse_still(const Column& column, const Fields& fields) const {
  const auto still = parse_fixed_point(fields.text(), 0);
  if (!still || !still->exact || (still->value != 0 && still->value != 1)) {
    throw bad_field(column, fields, "1 (still) or 0 (moving)",
                    "Write 0 where it is not known: such a sample is never calibrated on.");
  }
  return still->value == 1;
}

double Reader::parse_measured(const Column& column, const Fields& fields) const {
  const auto value = parse_real(fields.text());
  if (!value) {
    throw bad_field(column, fields, "a number such as -0.25 or 1e-3",
                    "Leave the cell empty or write nan where the value was lost.");
  }
  return *value;
}

Error Reader::bad_field(const Column& column, const Fields& fields, std::string expected,
                        std::string mend) const {
  return Error{lines_.place(fields.column()),
               fmt::format("{} as {}", excerpt(fields.text()), column.name), std::move(expected),
               std::move(mend)};
}

Error Reader::bad_field_count(std::string_view line) const {
  std::size_t count = 0;
  for (Fields fields{line}; fields.next();) {
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
