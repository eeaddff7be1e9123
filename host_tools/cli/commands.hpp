/// @file
/// The sub-commands of `zerorate`: each adds itself to the command line and returns what runs it.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host_tools/lib/live/tally.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the library chose the name
class App;
}

namespace zerorate::cli {

/// Exit codes of all commands.
enum ExitCode : int { success = 0, finding = 1, usage = 2, bad_data = 3, too_short = 4 };

/// A sub-command and what runs it once the command line is parsed.
struct Command {
  CLI::App* app;
  std::function<ExitCode()> run;
};

/// Shows a tally somewhere besides the terminal; ends with its last copy.
using ShowTally = std::function<void(const live::Tally& tally, const std::string& source,
                                     std::chrono::milliseconds silence)>;
/// Opens a page for browsers at an address and a port; 0: one that is free.
using OpenPage = std::function<ShowTally(const std::string& address, std::uint16_t port)>;

/// Gives every message of a recording that runs through a node.
/// @param model  name or file
using PlayRecording =
    std::function<void(const std::string& recording, const std::string& model,
                       const std::function<void(const wire::NumberedMessage&)>& take)>;

[[nodiscard]] Command add_replay(CLI::App& app);
[[nodiscard]] Command add_demo(CLI::App& app);
[[nodiscard]] Command add_model(CLI::App& app);
[[nodiscard]] Command add_export(CLI::App& app);
[[nodiscard]] Command add_simulate(CLI::App& app);
[[nodiscard]] Command add_characterize(CLI::App& app);
[[nodiscard]] Command add_evaluate(CLI::App& app);
[[nodiscard]] Command add_compare(CLI::App& app);
[[nodiscard]] Command add_diagnose(CLI::App& app);
/// @param open_page  nullptr: this build has none
[[nodiscard]] Command add_monitor(CLI::App& app, const OpenPage& open_page = nullptr);
[[nodiscard]] Command add_probe(CLI::App& app);
[[nodiscard]] Command add_record(CLI::App& app);
/// @param play_recording  nullptr: this build has none
[[nodiscard]] Command add_calibrate(CLI::App& app, const PlayRecording& play_recording = nullptr);
[[nodiscard]] Command add_odometer(CLI::App& app);
[[nodiscard]] Command add_convert(CLI::App& app);
[[nodiscard]] Command add_fleet(CLI::App& app);
[[nodiscard]] Command add_accept(CLI::App& app);

/// All that this build has: board_commands.cpp or desktop_commands.cpp.
[[nodiscard]] std::vector<Command> add_commands(CLI::App& app);

}  // namespace zerorate::cli
