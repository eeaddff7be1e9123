#include "host_tools/lib/report/report.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <utility>

#include "host_tools/lib/output/output_file.hpp"
#include "host_tools/lib/report/markup.hpp"
#include "host_tools/lib/report/web_assets.hpp"

namespace zerorate::report {
namespace {

constexpr std::size_t kSectionsThatNeedContents = 5;

/// Forbids every load over the network, so that a report cannot come to need one by accident.
constexpr std::string_view kContentPolicy =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:";

std::string anchor(std::size_t section) {
  return fmt::format("section-{}", section + 1);
}

std::string contents_html(const std::deque<Section>& sections) {
  if (sections.size() < kSectionsThatNeedContents) return "";
  std::string items;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    items += fmt::format("<li><a href=\"#{}\">{}</a></li>", anchor(i),
                         escape_html(sections[i].heading()));
  }
  return fmt::format("<nav aria-label=\"Contents\"><ol>{}</ol></nav>\n", items);
}

std::string head_html(const std::string& title) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<title>{}</title>\n<style>{}\n{}</style>\n</head>\n",
      kContentPolicy, escape_html(title), kPlotStyle, kReportStyle);
}

std::string scripts_html() {
  return fmt::format(
      "<script>/* uPlot\n{}\n*/\n{}</script>\n<script>(() => {{\n\"use "
      "strict\";\n{}}})();</script>\n",
      kPlotLicence, kPlotScript, kReportScript);
}

}  // namespace

Section& Section::paragraph(std::string_view text) {
  body_html_ += fmt::format("<p>{}</p>\n", escape_html(text));
  return *this;
}

Section& Section::listing(std::string_view text) {
  body_html_ += fmt::format("<pre tabindex=\"0\"><code>{}</code></pre>\n", escape_html(text));
  return *this;
}

Section& Section::key_figures(const std::vector<KeyFigure>& figures) {
  body_html_ += "<dl class=\"key-figures\">\n";
  for (const KeyFigure& figure : figures) {
    body_html_ += fmt::format(
        "<div><dt>{}</dt><dd><span class=\"value\">{}</span> <span class=\"remark\">{}</span></dd>"
        "</div>\n",
        escape_html(figure.name), escape_html(figure.value), escape_html(figure.remark));
  }
  body_html_ += "</dl>\n";
  return *this;
}

Section& Section::table(const Table& table) {
  body_html_ += render(table);
  return *this;
}

Section& Section::chart(const Chart& chart) {
  body_html_ += render(chart);
  return *this;
}

Section& Section::chart(const BarChart& chart) {
  body_html_ += render(chart);
  return *this;
}

Report::Report(std::string title, std::string lead)
    : title_(std::move(title)), lead_(std::move(lead)) {}

Section& Report::section(std::string heading) {
  return sections_.emplace_back(std::move(heading));
}

Report& Report::provenance(std::string text) {
  provenance_ = std::move(text);
  return *this;
}

std::string Report::html() const {
  std::string html = head_html(title_);
  html +=
      fmt::format("<body>\n<header><h1>{}</h1>\n<p class=\"lead\">{}</p>\n{}</header>\n<main>\n",
                  escape_html(title_), escape_html(lead_), contents_html(sections_));
  for (std::size_t i = 0; i < sections_.size(); ++i) {
    html += fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", anchor(i),
                        escape_html(sections_[i].heading()), sections_[i].body_html());
  }
  html += fmt::format(
      "</main>\n<footer>\n<p class=\"hint\">Drag across a chart to zoom, double-click to return; "
      "click a legend entry to hide it.</p>\n"
      "<noscript><p>The charts are drawn by scripts inside this file, which this browser does not "
      "run.</p></noscript>\n<p>{}</p>\n</footer>\n",
      escape_html(provenance_));
  return html + scripts_html() + "</body>\n</html>\n";
}

void Report::write(const std::filesystem::path& path) const {
  output::write_file(path, html());
}

std::string origin_in_words(double start_s) {
  constexpr double kEpoch_s = 1e8;  // in 1973: no clock that starts with its machine shows it
  if (start_s < 1.0) return "";
  if (start_s < kEpoch_s) {
    return fmt::format(" Times count from the first sample, at {:.0f} s of the recording's clock.",
                       start_s);
  }
  return fmt::format(" Times count from the first sample, at {:%Y-%m-%d %H:%M:%S} UTC.",
                     fmt::gmtime(static_cast<std::time_t>(start_s)));
}

}  // namespace zerorate::report
