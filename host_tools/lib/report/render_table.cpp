#include <fmt/format.h>

#include <stdexcept>

#include "host_tools/lib/report/markup.hpp"

namespace zerorate::report {
namespace {

const double* number_in(const Cell& cell) {
  return std::get_if<double>(&cell.content());
}

/// A column of numbers stands to the right, heading and stray texts ("n/a") included.
bool is_numeric(const Table& table, std::size_t column) {
  for (const auto& row : table.rows) {
    if (number_in(row[column]) != nullptr) return true;
  }
  return false;
}

std::string cell_html(const Cell& cell, int decimals) {
  if (const double* number = number_in(cell)) return format_number(*number, decimals);
  return escape_html(std::get<std::string>(cell.content()));
}

std::string heading_html(const Column& column) {
  if (column.unit.empty()) return escape_html(column.heading);
  return fmt::format("{} <span class=\"unit\">{}</span>", escape_html(column.heading),
                     escape_html(column.unit));
}

void check(const Table& table) {
  for (const auto& row : table.rows) {
    if (row.size() == table.columns.size()) continue;
    throw std::invalid_argument(fmt::format("table \"{}\": a row of {} cells under {} columns",
                                            table.caption, row.size(), table.columns.size()));
  }
}

}  // namespace

std::string render(const Table& table) {
  check(table);
  std::vector<std::string> alignment;
  std::string head;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    alignment.emplace_back(is_numeric(table, c) ? " class=\"number\"" : "");
    head +=
        fmt::format("<th scope=\"col\"{}>{}</th>", alignment[c], heading_html(table.columns[c]));
  }
  std::string body;
  for (const auto& row : table.rows) {
    body += "<tr>";
    for (std::size_t c = 0; c < row.size(); ++c) {
      body +=
          fmt::format("<td{}>{}</td>", alignment[c], cell_html(row[c], table.columns[c].decimals));
    }
    body += "</tr>\n";
  }
  const std::string caption =
      table.caption.empty()
          ? ""
          : fmt::format("<caption><span>{}</span></caption>", escape_html(table.caption));
  return fmt::format(
      "<div class=\"table\" tabindex=\"0\"><table>{}\n<thead><tr>{}</tr></thead>\n"
      "<tbody>\n{}</tbody></table></div>\n",
      caption, head, body);
}

}  // namespace zerorate::report
