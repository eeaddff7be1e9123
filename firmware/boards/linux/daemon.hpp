/// @file
/// zerorated from its start to its end.
#pragma once

#include <string>

namespace zerorate::linux_node {

/// Runs until SIGTERM or SIGINT; SIGHUP reads the file again and goes on with what it says, or, if
/// it is wrong, with what was said before. Throws toml_file::Error, std::system_error and
/// std::invalid_argument for what makes it impossible to begin.
void run_daemon(const std::string& configuration_file);

}  // namespace zerorate::linux_node
