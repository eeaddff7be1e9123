/// @file
/// From texts, tables and charts to HTML. Internal to the report.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "host_tools/lib/report/chart.hpp"
#include "host_tools/lib/report/table.hpp"

namespace zerorate::report {

/// Text as HTML content or quoted attribute value.
std::string escape_html(std::string_view text);

/// JSON that may stand inside `<script>`: no '<', so neither "</script>" nor "<!--" can occur in
/// it. Bytes that are not UTF-8 become U+FFFD.
std::string script_json(const nlohmann::json& json);

/// A number with fixed decimals, a true minus sign, and narrow spaces between thousands from five
/// digits on; a dash where it is not finite.
std::string format_number(double value, int decimals);

/// @throws std::invalid_argument where lengths disagree or x is not ascending.
std::string render(const Table& table);
std::string render(const Chart& chart);
std::string render(const BarChart& chart);

}  // namespace zerorate::report
