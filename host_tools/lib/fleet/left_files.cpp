#include "host_tools/lib/fleet/left_files.hpp"

#include <sys/types.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <string>
#include <string_view>
#include <system_error>

namespace zerorate::fleet {

void remove_of_dead_processes(const std::filesystem::path& out) {
  const std::string begin = out.filename().string() + '.';
  const auto folder = std::filesystem::absolute(out).parent_path();
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(begin)) continue;
    const std::string_view rest = std::string_view{name}.substr(begin.size());
    ::pid_t process = 0;
    const auto [stop, error] = std::from_chars(rest.data(), rest.data() + rest.size(), process);
    const std::string_view kind{stop, rest.data() + rest.size()};
    const bool is_temporary =
        error == std::errc{} &&
        (kind == ".merging" || kind == ".merging-journal" || kind == ".partial");
    const bool is_dead = is_temporary && ::kill(process, 0) != 0 && errno == ESRCH;
    if (is_dead) std::filesystem::remove(entry.path(), ignored);
  }
}

}  // namespace zerorate::fleet
