/// @file
/// A Unix socket with a name in the file system.
#pragma once

#include <net/if.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <cstdint>
#include <string>

#include "hal/linux/descriptor.hpp"

namespace zerorate::hal::linux_os {

/// Owns the name: it is made at the start, and removed at the end unless it has come to name
/// something else. A socket of that name on which nobody listens any more is replaced.
class NamedSocket {
 public:
  /// Whoever may enter the folder may send or connect. Neither side blocks.
  /// @param type  SOCK_DGRAM or SOCK_STREAM
  /// Throws std::system_error, with `path`, where the name is taken: by a socket somebody listens
  /// on (EADDRINUSE) or by anything that is not a socket (EEXIST), which stays as it is. Throws
  /// std::invalid_argument for a path that a socket cannot have.
  NamedSocket(const std::string& path, int type);
  NamedSocket(const NamedSocket&) = delete;
  NamedSocket& operator=(const NamedSocket&) = delete;
  ~NamedSocket();

  [[nodiscard]] int descriptor() const { return socket_.get(); }

 private:
  std::string path_;
  Descriptor socket_;
  dev_t device_ = 0;
  ino_t inode_ = 0;
};

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
