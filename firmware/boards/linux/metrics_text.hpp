/// @file
/// Counters of the service as text for Prometheus and for people.
#pragma once

#include <array>
#include <string_view>

#include "firmware/boards/linux/node_service.hpp"

namespace zerorate::linux_node {

using MetricsBuffer = std::array<char, 16384>;

/// The Prometheus text format, version 0.0.4. No heap.
[[nodiscard]] std::string_view format_metrics(const NodeService& service, MetricsBuffer& buffer);

}  // namespace zerorate::linux_node
