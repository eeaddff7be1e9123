#include "hal/linux/socket_address.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
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

bool is_loopback(const std::string& address) {
  in_addr ipv4{};
  if (inet_pton(AF_INET, address.c_str(), &ipv4) == 1) {
    return ntohl(ipv4.s_addr) >> 24U == IN_LOOPBACKNET;
  }
  in6_addr ipv6{};
  if (inet_pton(AF_INET6, address.c_str(), &ipv6) == 1) return IN6_IS_ADDR_LOOPBACK(&ipv6);
  return address == "localhost";
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
