/// @file
/// Main function of a program of commands: parses, runs, and turns what goes wrong into a message
/// and an exit code.
#pragma once

#include <vector>

#include "host_tools/cli/commands.hpp"

namespace zerorate::cli {

/// Names the program, adds its commands, parses the command line, runs the command that was asked
/// for, and flushes the standard output. An exception becomes one line on the standard error.
/// @param name opens each message
/// @param add adds options to the program; returns its sub-commands, or the program as the only one
/// @return the exit code of the process
[[nodiscard]] int run_program(const char* description, const char* name,
                              std::vector<Command> (*add)(CLI::App&), int argc,
                              char** argv) noexcept;

}  // namespace zerorate::cli
