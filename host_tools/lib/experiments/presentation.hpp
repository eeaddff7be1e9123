/// @file
/// The results of the experiments as people read them (text, report) and as programs do (JSON).
#pragma once

#include <string>
#include <vector>

#include "host_tools/lib/report/report.hpp"

namespace zerorate::experiments {

/// One experiment, ready to be shown.
struct Presentation {
  struct Part {
    std::string heading;
    std::vector<std::string> paragraphs{};
    std::vector<report::Table> tables{};
    std::vector<report::Chart> charts{};
    std::vector<report::BarChart> bars{};
  };

  std::string title;
  std::string lead;
  std::vector<Part> parts;
  std::string json;  ///< schema zerorate.reproduce/1, or the experiment's own
};

/// The tables for a terminal, without the charts.
[[nodiscard]] std::string to_text(const Presentation& presentation);
/// @param provenance the command that made it
[[nodiscard]] report::Report to_report(const Presentation& presentation, std::string provenance);

}  // namespace zerorate::experiments
