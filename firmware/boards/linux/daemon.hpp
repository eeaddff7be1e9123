/// @file
/// zerorated from its start to its end.
#pragma once

#include <string>
#include <vector>

namespace zerorate::linux_node {

/// Runs a node for each configuration until SIGTERM or SIGINT; SIGHUP reads the files again and
/// goes on with their contents, or, if one of them is wrong, with the former contents of all.
/// Throws toml_file::Error, std::system_error and std::invalid_argument for what makes it
/// impossible to begin.
void run_daemon(const std::vector<std::string>& configuration_files);

}  // namespace zerorate::linux_node
