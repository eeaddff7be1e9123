#include "host_tools/lib/contest/script.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <limits>
#include <system_error>
#include <thread>
#include <utility>

#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/fields.hpp"
#include "host_tools/lib/recording/number.hpp"
#include "host_tools/lib/units/units.hpp"

extern char** environ;  // NOLINT(readability-redundant-declaration): not every libc declares it

namespace zerorate::contest {
namespace {

/// Starts the shell in a process group of its own, so that what it starts ends with it.
pid_t start(const std::string& command, std::FILE* in, std::FILE* out, std::FILE* errors) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, fileno(in), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(out), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(errors), STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  std::string line = command;
  std::array<std::string, 2> words{"sh", "-c"};
  std::array<char*, 4> argv{words[0].data(), words[1].data(), line.data(), nullptr};
  pid_t child = 0;
  const int fault = posix_spawn(&child, "/bin/sh", &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (fault != 0) throw std::system_error(fault, std::generic_category(), "/bin/sh");
  return child;
}

/// Waits for the end of a program. Returns false where it was ended at the limit.
bool wait_for(pid_t child, double limit_s, int& status) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(limit_s);
  while (true) {
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) return true;
    if (ended < 0 && errno != EINTR) {
      throw std::system_error(errno, std::generic_category(), "waitpid");
    }
    if (Clock::now() >= end) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  (void)kill(-child, SIGKILL);
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return false;
}

/// The end of an error output in one line.
std::string last_words(std::string text) {
  constexpr std::size_t kLongest = 300;
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  if (text.empty()) return "it wrote nothing on its error output";
  if (text.size() > kLongest) text = "..." + text.substr(text.size() - kLongest);
  for (char& letter : text) {
    if (letter == '\n') letter = '|';
    if (static_cast<unsigned char>(letter) < 0x20) letter = ' ';
  }
  return "its error output: " + text;
}

}  // namespace

Script::Script(std::string command, double limit_s)
    : command_(std::move(command)), limit_s_(limit_s) {}

Script::File Script::temporary_file() {
  File file{std::tmpfile()};
  if (!file) throw std::system_error(errno, std::generic_category(), "temporary file");
  return file;
}

std::string Script::text_of(std::FILE* file) {
  std::rewind(file);
  std::string text;
  std::array<char, 4096> part{};
  for (std::size_t read = 0; (read = std::fread(part.data(), 1, part.size(), file)) > 0;) {
    text.append(part.data(), read);
  }
  return text;
}

std::string Script::run() {
  if (std::fflush(input_.get()) != 0) {
    throw std::system_error(errno, std::generic_category(), "temporary file");
  }
  std::rewind(input_.get());
  int status = 0;
  const pid_t child = start(command_, input_.get(), output_.get(), errors_.get());
  if (!wait_for(child, limit_s_, status)) {
    throw recording::DataError(
        fmt::format("the program {} was ended after {:g} s; --script-seconds gives it more",
                    recording::excerpt(command_), limit_s_));
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw recording::DataError(
        fmt::format("the program {} ended with {}; {}", recording::excerpt(command_),
                    WIFEXITED(status) ? fmt::format("exit code {}", WEXITSTATUS(status))
                                      : fmt::format("signal {}", WTERMSIG(status)),
                    last_words(text_of(errors_.get()))));
  }
  return text_of(output_.get());
}

std::vector<std::array<double, 3>> biases_of(std::string_view answer, std::size_t stops,
                                             std::size_t axes) {
  std::vector<std::array<double, 3>> biases;
  std::size_t number = 0;
  while (!answer.empty()) {
    const std::string_view line = answer.substr(0, answer.find('\n'));
    answer.remove_prefix(std::min(line.size() + 1, answer.size()));
    ++number;
    std::array<double, 3> bias{};
    bias.fill(std::numeric_limits<double>::quiet_NaN());
    std::size_t read = 0;
    bool is_numeric = true;
    for (recording::Fields fields{line, ','}; fields.next(); ++read) {
      std::string_view text = fields.text();
      if (text.ends_with('\r')) text.remove_suffix(1);
      const auto value = recording::parse_real(text);
      is_numeric = is_numeric && value.has_value() && read < axes;
      if (value && read < axes) bias[read] = *value * units::kRadPerDeg;
    }
    if (is_numeric && read == axes) {
      biases.push_back(bias);
    } else if (!biases.empty() || line.find_first_of("0123456789") == 0) {
      throw recording::DataError(
          fmt::format("line {} of the program's answer is {}; expected {} in deg/s", number,
                      recording::excerpt(line),
                      axes == 1 ? "a bias" : fmt::format("{} biases, separated by commas", axes)));
    }
  }
  if (biases.size() == stops) return biases;
  throw recording::DataError(
      fmt::format("the program answered {} lines of biases for {} stops; expected one for each",
                  biases.size(), stops));
}

}  // namespace zerorate::contest
