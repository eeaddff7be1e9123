#include "host_tools/cli/program.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <optional>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

#include "firmware/toml/error.hpp"
#include "hal/linux/standard_output.hpp"
#include "host_tools/lib/output/output_file.hpp"

namespace zerorate::cli {
namespace {

ExitCode complain(const CLI::App& app, const char* what, ExitCode code) {
  fmt::print(stderr, "{}: {}\n", app.get_name(), hal::linux_os::printable(what));
  return code;
}

/// The one place where exceptions become messages and exit codes.
ExitCode run_guarded(const CLI::App& app, const Command& command) {
  try {
    return command.run();
  } catch (const std::invalid_argument& error) {
    return complain(app, error.what(), usage);
  } catch (const std::exception& error) {
    return complain(app, error.what(), bad_data);
  }
}

/// Text that was lost on its way, as on a full disk, makes a command that was done one that failed.
ExitCode after_output(const CLI::App& app, ExitCode code) {
  try {
    hal::linux_os::flush_standard_output();
    return code;
  } catch (const std::system_error& error) {
    return complain(app, error.what(), bad_data);
  }
}

/// Answers `help [COMMAND]`, and a first word that is no command; nullopt where the words are to be
/// parsed.
std::optional<ExitCode> answer_without_parsing(CLI::App& app, std::span<char*> words) {
  std::vector<std::string_view> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  if (names.empty() || words.empty() || words[0][0] == '-') return std::nullopt;
  const bool asks_for_help = std::string_view{words[0]} == "help";
  if (asks_for_help && words.size() == 1) {
    fmt::print("{}", app.help());
    return success;
  }
  const std::string_view name = words[asks_for_help ? 1 : 0];
  if (std::ranges::find(names, name) == names.end()) {
    return complain(app,
                    fmt::format("no command is called \"{}\"{} ('{} --help' lists them)", name,
                                toml_file::suggestion(name, names), app.get_name())
                        .c_str(),
                    usage);
  }
  if (!asks_for_help) return std::nullopt;
  fmt::print("{}", app.get_subcommand(std::string{name})->help(app.get_name()));
  return success;
}

ExitCode parse_and_run(CLI::App& app, const std::vector<Command>& commands, int argc, char** argv) {
  const std::span<char*> words{argv + 1, static_cast<std::size_t>(std::max(argc, 1) - 1)};
  if (const auto answered = answer_without_parsing(app, words)) return *answered;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream text;  // not std::cout, whose flush would lose the reason of a failure
    const int code = app.exit(error, text);
    fmt::print("{}", text.str());
    return code == 0 ? success : usage;
  }
  for (const Command& command : commands) {
    if (command.app->parsed()) return run_guarded(app, command);
  }
  return usage;
}

}  // namespace

int run_program(const char* description, const char* name, std::vector<Command> (*add)(CLI::App&),
                int argc, char** argv) noexcept {
  try {
    output::remove_partial_files_on_signals();
    CLI::App app{description, name};
    const std::vector<Command> commands = add(app);
    return after_output(app, parse_and_run(app, commands, argc, argv));
  } catch (const std::system_error& error) {  // a help text that was lost, as on a full disk
    static_cast<void>(std::fprintf(stderr, "%s: %s\n", name, error.what()));
    return bad_data;
  } catch (...) {  // no memory, or what the error stream itself refused to print
    return bad_data;
  }
}

}  // namespace zerorate::cli
