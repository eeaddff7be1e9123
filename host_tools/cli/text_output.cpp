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

}  // namespace zerorate::cli
