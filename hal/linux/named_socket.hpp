/// @file
/// A Unix socket with a name in the file system.
#pragma once

#include <sys/types.h>

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

}  // namespace zerorate::hal::linux_os
