/// @file
/// Results as people read them (text, report) and as programs do (JSON).
#pragma once

#include <string>
#include <vector>

#include "host_tools/lib/report/report.hpp"

namespace zerorate::report {

/// Results of one command, ready to be shown.
struct Presentation {
  struct Part {
    std::string heading;
    std::vector<std::string> paragraphs{};
    std::vector<Table> tables{};
    std::vector<Chart> charts{};
    std::vector<BarChart> bars{};
  };

  std::string title;
  std::string lead;
  std::vector<Part> parts;
  std::string json;  ///< object of a schema that the producer names
};

/// The tables for a terminal, without the charts.
[[nodiscard]] std::string to_text(const Presentation& presentation);
/// @param provenance the command that made it
[[nodiscard]] Report to_report(const Presentation& presentation, std::string provenance);

}  // namespace zerorate::report
