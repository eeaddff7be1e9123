/// @file
/// The frames of CAN sinks for other tools: a DBC file with the identifiers, cycle times and
/// receivers of one bus.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "firmware/boards/linux/outputs/sink_settings.hpp"

namespace zerorate::linux_node {

/// Facts of a DBC file beside the frames.
struct DbcFacts {
  double rate_hz = 0.0;                ///< messages per second before any divider
  std::vector<std::string> receivers;  ///< nodes of the bus that read; none: Vector__XXX
};

/// Sinks of one bus as a DBC file. Throws std::invalid_argument where two frames have one
/// identifier or one name, and where a receiver's name is no identifier of C.
[[nodiscard]] std::string format_dbc(std::span<const CanSettings> sinks, const DbcFacts& facts);

}  // namespace zerorate::linux_node
