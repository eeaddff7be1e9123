#include "hal/linux/named_socket.hpp"

#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "hal/linux/socket_address.hpp"

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

}  // namespace zerorate::hal::linux_os
