#include "host_tools/lib/report/presentation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace zerorate::report {
namespace {

std::string heading_of(const Column& column) {
  return column.unit.empty() ? column.heading : column.heading + " " + column.unit;
}

std::string text_of(const Cell& cell, const Column& column) {
  if (const auto* text = std::get_if<std::string>(&cell.content())) return *text;
  const double number = std::get<double>(cell.content());
  return std::isfinite(number) ? fmt::format("{:.{}f}", number, column.decimals) : "-";
}

/// Text to the left, numbers to the right.
std::string line(const std::vector<std::string>& texts, const std::vector<std::size_t>& widths,
                 const std::vector<bool>& is_text) {
  std::string result;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    if (i > 0) result += "  ";
    result += is_text[i] ? fmt::format("{:<{}}", texts[i], widths[i])
                         : fmt::format("{:>{}}", texts[i], widths[i]);
  }
  return result + "\n";
}

std::string table_text(const Table& table) {
  std::vector<std::vector<std::string>> lines(1);
  std::vector<bool> is_text(table.columns.size(), true);
  for (const auto& column : table.columns) lines[0].push_back(heading_of(column));
  for (const auto& row : table.rows) {
    auto& texts = lines.emplace_back();
    for (std::size_t i = 0; i < row.size(); ++i) {
      texts.push_back(text_of(row[i], table.columns[i]));
      if (std::holds_alternative<double>(row[i].content())) is_text[i] = false;
    }
  }
  std::vector<std::size_t> widths(table.columns.size());
  for (const auto& texts : lines) {
    for (std::size_t i = 0; i < texts.size(); ++i) widths[i] = std::max(widths[i], texts[i].size());
  }
  std::string result = table.caption + "\n";
  for (const auto& texts : lines) result += line(texts, widths, is_text);
  return result + "\n";
}

}  // namespace

std::string to_text(const Presentation& presentation) {
  std::string text = presentation.title + "\n\n";
  for (const auto& part : presentation.parts) {
    for (const Table& table : part.tables) text += table_text(table);
  }
  return text;
}

Report to_report(const Presentation& presentation, std::string provenance) {
  Report report{presentation.title, presentation.lead};
  for (const auto& part : presentation.parts) {
    Section& section = report.section(part.heading);
    for (const auto& paragraph : part.paragraphs) section.paragraph(paragraph);
    for (const auto& table : part.tables) section.table(table);
    for (const auto& chart : part.charts) section.chart(chart);
    for (const auto& bars : part.bars) section.chart(bars);
  }
  report.provenance(std::move(provenance));
  return report;
}

}  // namespace zerorate::report
