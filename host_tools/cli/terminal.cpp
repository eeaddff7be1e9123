#include "host_tools/cli/terminal.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host_tools/lib/output/output_file.hpp"

namespace zerorate::cli {

void write_text(const std::filesystem::path& path, const std::string& text) {
  if (path == "-") {
    fmt::print("{}", text);
  } else {
    output::write_file(path, text);
  }
}

std::string wrapped(std::string_view paragraph) {
  constexpr std::size_t kWidth = 100;
  std::string lines(paragraph);
  std::size_t begin = 0;
  while (lines.size() - begin > kWidth) {
    const std::size_t space = lines.rfind(' ', begin + kWidth);
    if (space == std::string::npos || space <= begin) break;
    lines[space] = '\n';
    begin = space + 1;
  }
  return lines;
}

std::string aligned(const std::vector<std::vector<std::string>>& rows) {
  constexpr std::size_t kGap = 2;
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string lines;
  for (const auto& row : rows) {
    for (std::size_t i = 0; i + 1 < row.size(); ++i) {
      lines += fmt::format("{:<{}}", row[i], widths[i] + kGap);
    }
    lines += row.back() + '\n';
  }
  return lines;
}

ProgressBar::ProgressBar(std::string what)
    : what_(std::move(what)), visible_(::isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
}

void ProgressBar::update(std::optional<double> share, const std::string& remark) {
  const auto now = Clock::now();
  if (!visible_ || now - drawn_at_ < std::chrono::milliseconds(100)) return;
  drawn_at_ = now;
  drawn_ = true;
  const double elapsed_s = std::chrono::duration<double>(now - started_).count();
  if (!share) {
    fmt::print(stderr, "\r\033[K{} {:.0f} s", what_, elapsed_s);
  } else {
    constexpr int kWidth = 30;
    const int filled = static_cast<int>(std::clamp(*share, 0.0, 1.0) * kWidth);
    fmt::print(stderr, "\r\033[K{} [{:#<{}}{:.<{}}] {:3.0f} %", what_, "", filled, "",
               kWidth - filled, *share * 100.0);
    if (*share > 0.02) fmt::print(stderr, ", {:.0f} s left", elapsed_s * (1.0 / *share - 1.0));
  }
  if (!remark.empty()) fmt::print(stderr, ", {}", remark);
  std::fflush(stderr);
}

std::string cell(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "-";
}

}  // namespace zerorate::cli
