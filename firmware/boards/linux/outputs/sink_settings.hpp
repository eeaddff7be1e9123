/// @file
/// Where a configuration wants messages to go.
#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "firmware/wire/e2e_profile11.hpp"

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
/// Frames of one message on a CAN bus.
enum class CanLayout : std::uint8_t {
  axes,  ///< status, a frame for each axis, and those of turn, inputs and so on
  yaw,   ///< one protected frame with the yaw rate
  fd,    ///< one protected frame of CAN FD with all axes, and those of turn, inputs and so on
};
/// Frames on a CAN bus.
struct CanSettings {
  std::string interface;
  std::uint16_t id = 0;  ///< identifier of the first frame; the others follow it
  CanLayout layout = CanLayout::axes;
  std::uint32_t every = 1;  ///< sends the first of so many messages
  wire::E2eSettings e2e;    ///< protection of the layouts yaw and fd
};
using SinkSettings = std::variant<JsonSettings, UdpSettings, UnixSettings, CanSettings>;

}  // namespace zerorate::linux_node
