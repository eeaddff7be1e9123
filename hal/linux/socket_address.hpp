/// @file
/// Addresses of sockets, as the calls on sockets take them.
#pragma once

#include <net/if.h>
#include <sys/socket.h>

#include <cstdint>
#include <string>

namespace zerorate::hal::linux_os {

/// An address of any family.
struct SocketAddress {
  sockaddr_storage storage{};
  socklen_t size = 0;

  [[nodiscard]] const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }
};

/// @param address  numeric, IPv4 or IPv6; throws std::invalid_argument where it is not
[[nodiscard]] SocketAddress udp_address(const std::string& address, std::uint16_t port);

/// Whether only programs of this machine reach the address: numeric in 127.0.0.0/8 or ::1, or
/// "localhost".
[[nodiscard]] bool is_loopback(const std::string& address);

/// Throws std::invalid_argument where the path is empty or longer than the kernel takes.
[[nodiscard]] SocketAddress unix_address(const std::string& path);

/// A question to the kernel about a network interface, which need not be there. Throws
/// std::invalid_argument where the name is empty or longer than the kernel takes.
[[nodiscard]] ifreq interface_request(const std::string& name);

}  // namespace zerorate::hal::linux_os
