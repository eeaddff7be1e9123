/// @file
/// Tables of a report: text to the left, numbers to the right with their digits below each other.
#pragma once

#include <concepts>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace zerorate::report {

/// Text or a number.
class Cell {
 public:
  // Implicit on purpose: rows are written as {"kalman", 12, 0.42}.
  Cell(std::string text) : content_(std::move(text)) {}
  Cell(const char* text) : content_(std::string(text)) {}
  template <class T>
  requires std::integral<T> || std::floating_point<T> Cell(T number)
      : content_(static_cast<double>(number)) {}

  [[nodiscard]] const std::variant<std::string, double>& content() const { return content_; }

 private:
  std::variant<std::string, double> content_;
};

struct Column {
  std::string heading{};
  std::string unit{};  ///< set below the heading; empty for text, ratios and counts
  int decimals = 0;    ///< decimals of all numbers in the column
};

/// Every row has one cell a column. Numbers that are not finite are shown as a dash.
struct Table {
  std::string caption{};
  std::vector<Column> columns{};
  std::vector<std::vector<Cell>> rows{};
};

/// One of the few numbers a report is about, as text: {"Heading drift", "0.42°", "rms per drive"}.
struct KeyFigure {
  std::string name{};
  std::string value{};
  std::string remark{};
};

}  // namespace zerorate::report
