#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <string>

#include "host_tools/cli/commands.hpp"

namespace zerorate::cli {
namespace {

/// Command that needs the libraries of a desktop: prints where it is available.
Command add_absent(CLI::App& app, const std::string& name) {
  auto* command = app.add_subcommand(name, "In the desktop build of zerorate only");
  command->set_help_flag();
  command->prefix_command();
  command->group("Commands of the desktop build");
  return {command, [name] {
            fmt::print(stderr,
                       "zerorate: {} is in the desktop build of zerorate, not in this one of the "
                       "node. Copy the recording to a PC; there, in a clone of zerorate:\n"
                       "  cmake --preset host-release && cmake --build --preset host-release\n"
                       "  build/host-release/host_tools/cli/zerorate {} --help\n",
                       name, name);
            return usage;
          }};
}

}  // namespace

std::vector<Command> add_commands(CLI::App& app) {
  std::vector<Command> commands{add_calibrate(app), add_model(app), add_monitor(app),
                                add_probe(app), add_record(app)};
  for (const char* name : {"characterize", "demo", "diagnose", "evaluate", "export", "odometer",
                           "replay", "simulate"}) {
    commands.push_back(add_absent(app, name));
  }
  return commands;
}

}  // namespace zerorate::cli
