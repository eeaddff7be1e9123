#include "host_tools/cli/commands.hpp"

namespace zerorate::cli {

std::vector<Command> add_commands(CLI::App& app) {
  return {add_model(app), add_monitor(app), add_probe(app)};
}

}  // namespace zerorate::cli
