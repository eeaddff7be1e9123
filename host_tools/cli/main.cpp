#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <stdexcept>
#include <vector>

#include "host_tools/cli/commands.hpp"

namespace zerorate::cli {
namespace {

ExitCode complain(const char* what, ExitCode code) {
  fmt::print(stderr, "zerorate: {}\n", what);
  return code;
}

/// The one place where exceptions become messages and exit codes.
ExitCode run_guarded(const Command& command) {
  try {
    return command.run();
  } catch (const std::invalid_argument& error) {
    return complain(error.what(), usage);
  } catch (const std::exception& error) {
    return complain(error.what(), bad_data);
  }
}

ExitCode run(int argc, char** argv) {
  CLI::App app{"zerorate: bias prediction for MEMS gyroscopes, from recordings", "zerorate"};
  app.set_version_flag("--version", "zerorate " ZERORATE_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 1 done with a finding, 2 wrong usage, 3 data that cannot be used.\n"
      "'zerorate COMMAND --help' shows the options and examples of a command.");
  const std::vector<Command> commands = add_commands(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? success : usage;
  }
  for (const Command& command : commands) {
    if (command.app->parsed()) return run_guarded(command);
  }
  return usage;
}

}  // namespace
}  // namespace zerorate::cli

int main(int argc, char** argv) {
  try {
    return zerorate::cli::run(argc, argv);
  } catch (...) {  // only what the error stream itself refused to print comes this far
    return zerorate::cli::bad_data;
  }
}
