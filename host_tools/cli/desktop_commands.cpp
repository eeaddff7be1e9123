#include "host_tools/cli/commands.hpp"

namespace zerorate::cli {

std::vector<Command> add_commands(CLI::App& app) {
  return {add_replay(app), add_demo(app),     add_characterize(app), add_model(app),
          add_export(app), add_evaluate(app), add_diagnose(app),     add_monitor(app),
          add_probe(app),  add_simulate(app), add_odometer(app)};
}

}  // namespace zerorate::cli
