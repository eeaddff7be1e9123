#include "hal/linux/named_socket.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <stdexcept>
#include <system_error>

namespace zerorate::hal::linux_os {
namespace {

[[noreturn]] void fail(int reason, const std::string& path) {
  throw std::system_error(reason, std::generic_category(), path);
}

Descriptor open_socket(int type) {
  return checked_descriptor(socket(AF_UNIX, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0), "socket");
}

/// Removes a socket whose process was killed. A file refuses a connection just as such a socket
/// does.
void make_room(const std::string& path, const SocketAddress& address, int type) {
  struct stat existing {};
  if (lstat(path.c_str(), &existing) != 0) return;
  if (!S_ISSOCK(existing.st_mode)) fail(EEXIST, path);
  const Descriptor visitor = open_socket(type);
  const bool is_deserted =
      connect(visitor.get(), address.get(), address.size) != 0 && errno == ECONNREFUSED;
  if (is_deserted) (void)unlink(path.c_str());
}

}  // namespace

NamedSocket::NamedSocket(const std::string& path, int type)
    : path_(path), socket_(open_socket(type)) {
  const SocketAddress address = unix_address(path);
  make_room(path, address, type);
  if (bind(socket_.get(), address.get(), address.size) != 0) fail(errno, path);
  struct stat made {};
  if (lstat(path.c_str(), &made) == 0) {
    device_ = made.st_dev;
    inode_ = made.st_ino;
  }
  constexpr mode_t kEverybody = 0666;
  (void)chmod(path.c_str(), kEverybody);
}

NamedSocket::~NamedSocket() {
  struct stat present {};
  const bool is_ours =
      lstat(path_.c_str(), &present) == 0 && present.st_dev == device_ && present.st_ino == inode_;
  if (is_ours) (void)unlink(path_.c_str());
}

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
