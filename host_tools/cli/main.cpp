#include <CLI/CLI.hpp>
#include <vector>

#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/program.hpp"

namespace {

std::vector<zerorate::cli::Command> add(CLI::App& app) {
  app.set_version_flag("--version", "zerorate " ZERORATE_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 1 done with a finding, 2 wrong usage, 3 data that cannot be used,\n"
      "or output that cannot be written, 4 a recording is too short to decide ('accept').\n"
      "'zerorate COMMAND --help' shows the options and examples of a command.");
  return zerorate::cli::add_commands(app);
}

}  // namespace

int main(int argc, char** argv) {
  return zerorate::cli::run_program(
      "zerorate: bias prediction for MEMS gyroscopes, from recordings", "zerorate", add, argc,
      argv);
}
