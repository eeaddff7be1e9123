#include <CLI/CLI.hpp>

#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/program.hpp"

int main(int argc, char** argv) {
  CLI::App app{"zerorate: bias prediction for MEMS gyroscopes, from recordings", "zerorate"};
  app.set_version_flag("--version", "zerorate " ZERORATE_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 1 done with a finding, 2 wrong usage, 3 data that cannot be used,\n"
      "or output that cannot be written.\n"
      "'zerorate COMMAND --help' shows the options and examples of a command.");
  return zerorate::cli::run_program(app, zerorate::cli::add_commands(app), argc, argv);
}
