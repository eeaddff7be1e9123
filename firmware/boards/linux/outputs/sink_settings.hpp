/// @file
/// Where a configuration wants messages to go.
#pragma once

#include <cstdint>
#include <string>
#include <variant>

namespace zerorate::linux_node {

/// JSON lines, to a file or, with "-", to the standard output.
struct JsonSettings {
  std::string file;
};
/// Rate frames as UDP datagrams.
struct UdpSettings {
  std::string address;  ///< numeric, IPv4 or IPv6
  std::uint16_t port = 0;
};
/// Rate frames as datagrams on a Unix socket.
struct UnixSettings {
  std::string path;
};
/// Frames on a CAN bus.
struct CanSettings {
  std::string interface;
  std::uint16_t id = 0;  ///< identifier of the status frame
};
using SinkSettings = std::variant<JsonSettings, UdpSettings, UnixSettings, CanSettings>;

}  // namespace zerorate::linux_node
