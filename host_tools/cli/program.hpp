/// @file
/// Main function of a program of commands: parses, runs, and turns what goes wrong into a message
/// and an exit code.
#pragma once

#include <vector>

#include "host_tools/cli/commands.hpp"

namespace zerorate::cli {

/// Parses the command line, runs the command that was asked for, and flushes the standard output.
/// An exception of the command becomes one line on the standard error.
/// @param app its name opens each message
/// @param commands sub-commands of `app`, or `app` itself
/// @return the exit code of the process
[[nodiscard]] int run_program(CLI::App& app, const std::vector<Command>& commands, int argc,
                              char** argv) noexcept;

}  // namespace zerorate::cli
