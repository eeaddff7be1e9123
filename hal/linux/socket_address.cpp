#include "hal/linux/socket_address.hpp"

#include <netdb.h>
#include <sys/un.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <stdexcept>

namespace zerorate::hal::linux_os {

SocketAddress udp_address(const std::string& address, std::uint16_t port) {
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &found) != 0) {
    throw std::invalid_argument("udp: \"" + address + "\" is not a numeric address");
  }
  SocketAddress result;
  std::memcpy(&result.storage, found->ai_addr, found->ai_addrlen);
  result.size = found->ai_addrlen;
  freeaddrinfo(found);
  return result;
}

SocketAddress unix_address(const std::string& path) {
  sockaddr_un named{};
  named.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof named.sun_path) {
    throw std::invalid_argument("unix: \"" + path + "\" is not a path of at most " +
                                std::to_string(sizeof named.sun_path - 1) + " bytes");
  }
  std::ranges::copy(path, std::begin(named.sun_path));
  SocketAddress result;
  std::memcpy(&result.storage, &named, sizeof named);
  result.size = sizeof named;
  return result;
}

ifreq interface_request(const std::string& name) {
  if (name.empty() || name.size() >= IFNAMSIZ) {
    throw std::invalid_argument("can: \"" + name + "\" is not an interface's name");
  }
  ifreq request{};
  std::ranges::copy(name, std::begin(request.ifr_name));
  return request;
}

}  // namespace zerorate::hal::linux_os
