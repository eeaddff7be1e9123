#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "hal/linux/standard_output.hpp"
#include "host_tools/cli/commands.hpp"
#include "host_tools/lib/output/output_file.hpp"

namespace zerorate::cli {
namespace {

ExitCode complain(const char* what, ExitCode code) {
  fmt::print(stderr, "zerorate: {}\n", hal::linux_os::printable(what));
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

/// Text that was lost on its way, as on a full disk, makes a command that was done one that failed.
ExitCode after_output(ExitCode code) {
  try {
    hal::linux_os::flush_standard_output();
    return code;
  } catch (const std::system_error& error) {
    return complain(error.what(), bad_data);
  }
}

ExitCode run(int argc, char** argv) {
  CLI::App app{"zerorate: bias prediction for MEMS gyroscopes, from recordings", "zerorate"};
  app.set_version_flag("--version", "zerorate " ZERORATE_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 1 done with a finding, 2 wrong usage, 3 data that cannot be used,\n"
      "or output that cannot be written.\n"
      "'zerorate COMMAND --help' shows the options and examples of a command.");
  const std::vector<Command> commands = add_commands(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream text;  // not std::cout, whose flush would lose the reason of a failure
    const int code = app.exit(error, text);
    fmt::print("{}", text.str());
    return code == 0 ? success : usage;
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
    zerorate::output::remove_partial_files_on_signals();
    return zerorate::cli::after_output(zerorate::cli::run(argc, argv));
  } catch (...) {  // only what the error stream itself refused to print comes this far
    return zerorate::cli::bad_data;
  }
}
