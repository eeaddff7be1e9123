/// @file
/// The sub-commands of `zerorate`: each adds itself to the command line and returns what runs it.
#pragma once

#include <functional>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library chose the name
class App;
}

namespace zerorate::cli {

/// Exit codes, which tell a shell how a command ended.
enum ExitCode : int { success = 0, finding = 1, usage = 2, bad_data = 3 };

/// A sub-command and what runs it once the command line is parsed.
struct Command {
  CLI::App* app;
  std::function<ExitCode()> run;
};

[[nodiscard]] Command add_replay(CLI::App& app);
[[nodiscard]] Command add_demo(CLI::App& app);
[[nodiscard]] Command add_model(CLI::App& app);
[[nodiscard]] Command add_export(CLI::App& app);
[[nodiscard]] Command add_simulate(CLI::App& app);
[[nodiscard]] Command add_characterize(CLI::App& app);
[[nodiscard]] Command add_evaluate(CLI::App& app);
[[nodiscard]] Command add_diagnose(CLI::App& app);
[[nodiscard]] Command add_monitor(CLI::App& app);
[[nodiscard]] Command add_probe(CLI::App& app);
[[nodiscard]] Command add_odometer(CLI::App& app);

/// All that this build has: board_commands.cpp or desktop_commands.cpp.
[[nodiscard]] std::vector<Command> add_commands(CLI::App& app);

}  // namespace zerorate::cli
