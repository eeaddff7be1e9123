/// @file
/// A report as one HTML file: opens from disk without a network, in light and dark, on a phone and
/// on paper.
///
///     Report report{"Replay of run 1", "Three axes, 33 h at rest, 1 Hz."};
///     report.section("Heading drift").paragraph("…").table(table).chart(chart);
///     report.write("run1.html");
///
/// All texts are plain text; what looks like markup in them is shown, not obeyed.
#pragma once

#include <deque>
#include <filesystem>
#include <string>
#include <string_view>

#include "host_tools/lib/report/chart.hpp"
#include "host_tools/lib/report/table.hpp"

namespace zerorate::report {

/// A heading and what stands below it, in the order of the calls.
/// Inconsistent charts and tables are refused with std::invalid_argument, which names them.
class Section {
 public:
  explicit Section(std::string heading) : heading_(std::move(heading)) {}

  Section& paragraph(std::string_view text);
  /// Text in a fixed-width face with its line breaks: a command, a file.
  Section& listing(std::string_view text);
  Section& key_figures(const std::vector<KeyFigure>& figures);
  Section& table(const Table& table);
  /// The chart is thinned for display here (see thin_for_display), so a report of charts of 10^6
  /// points neither keeps them nor writes them. Cost: one pass over the points.
  Section& chart(const Chart& chart);
  Section& chart(const BarChart& chart);

  [[nodiscard]] const std::string& heading() const { return heading_; }
  [[nodiscard]] const std::string& body_html() const { return body_html_; }

 private:
  std::string heading_;
  std::string body_html_;
};

class Report {
 public:
  /// @param lead  the result in one paragraph: what a reader in a hurry takes away.
  Report(std::string title, std::string lead);

  /// Adds a section; the reference stays valid as long as the report. From five sections on the
  /// report opens with a table of contents.
  Section& section(std::string heading);

  /// The last line: program, version, command, seed; whatever makes the report once more.
  Report& provenance(std::string text);

  [[nodiscard]] std::string html() const;

  /// Writes an output::OutputFile, so that `path` never holds half a report.
  /// @throws std::system_error naming the path and the reason; `path` is then as it was.
  void write(const std::filesystem::path& path) const;

 private:
  std::string title_;
  std::string lead_;
  std::string provenance_;
  std::deque<Section> sections_;
};

/// Sentence for a lead, with a blank before it: when the first sample was, from which charts with
/// its time as `Axis::origin` count. Stamps since 1970 become a date; empty within the clock's
/// first second.
[[nodiscard]] std::string origin_in_words(double start_s);

}  // namespace zerorate::report
