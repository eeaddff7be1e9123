#include "host_tools/lib/report/markup.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace zerorate::report {
namespace {

constexpr std::string_view kMinus = "\u2212";
constexpr std::string_view kNarrowSpace = "\u202f";
constexpr std::string_view kDash = "\u2013";

std::string group_thousands(std::string_view digits) {
  if (digits.size() < 5) return std::string(digits);
  std::string grouped;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) grouped += kNarrowSpace;
    grouped += digits[i];
  }
  return grouped;
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string script_json(const nlohmann::json& json) {
  const std::string raw = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string safe;
  safe.reserve(raw.size());
  for (const char c : raw) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string format_number(double value, int decimals) {
  if (!std::isfinite(value)) return std::string(kDash);
  const std::string magnitude = fmt::format("{:.{}f}", std::abs(value), decimals);
  const bool rounds_to_zero = magnitude.find_first_not_of("0.") == std::string::npos;
  const std::size_t point = std::min(magnitude.find('.'), magnitude.size());
  return fmt::format("{}{}{}", value < 0 && !rounds_to_zero ? kMinus : "",
                     group_thousands(std::string_view(magnitude).substr(0, point)),
                     magnitude.substr(point));
}

}  // namespace zerorate::report
