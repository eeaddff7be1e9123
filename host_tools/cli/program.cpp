#include "host_tools/cli/program.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <sstream>
#include <stdexcept>
#include <system_error>

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

ExitCode parse_and_run(CLI::App& app, const std::vector<Command>& commands, int argc, char** argv) {
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
