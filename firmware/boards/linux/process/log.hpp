/// @file
/// Log of the service: one line for each change.
#pragma once

#include <functional>
#include <string_view>

namespace zerorate::linux_node {

/// Takes one line a call, without a newline at its end.
using Log = std::function<void(std::string_view line)>;

}  // namespace zerorate::linux_node
