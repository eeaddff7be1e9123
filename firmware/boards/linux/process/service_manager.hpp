/// @file
/// Messages to systemd by its notification protocol (sd_notify(3)): datagrams to the socket that
/// $NOTIFY_SOCKET names. Without the variable nothing is told.
#pragma once

#include <string_view>

#include "core/base/time.hpp"

namespace zerorate::linux_node {

/// Sends one message, such as "READY=1".
void notify_service_manager(std::string_view message);

/// Whether the watchdog ($WATCHDOG_USEC) is on: then "WATCHDOG=1" is due at least once in half of
/// it.
[[nodiscard]] bool is_watched();

}  // namespace zerorate::linux_node
