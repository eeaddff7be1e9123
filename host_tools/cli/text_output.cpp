#include "host_tools/cli/text_output.hpp"

#include <fmt/format.h>

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

}  // namespace zerorate::cli
