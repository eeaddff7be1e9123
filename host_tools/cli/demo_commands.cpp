#include "host_tools/cli/commands.hpp"

namespace zerorate::cli {

std::vector<Command> add_commands(CLI::App& app) {
  return {add_demo(app)};
}

}  // namespace zerorate::cli
