#include "firmware/boards/linux/outputs/metrics_endpoint.hpp"

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <system_error>

#include "hal/linux/descriptor.hpp"

namespace zerorate::linux_node {

using hal::linux_os::Descriptor;

MetricsEndpoint::MetricsEndpoint(const MetricsSettings& settings)
    : settings_(settings), file_while_written_(settings.file + ".new") {
  if (settings_.socket.empty()) return;
  constexpr int kBacklog = 4;
  try {
    listener_.emplace(settings_.socket, SOCK_STREAM);
  } catch (const std::system_error& error) {
    const bool lacks_folder = error.code().value() == ENOENT;
    throw std::runtime_error(
        std::string{"\"socket\" in [metrics]: "} + error.what() +
        (lacks_folder ? " (make its folder first; systemd makes /run/zerorate)" : ""));
  }
  if (listen(listener_->descriptor(), kBacklog) != 0) {
    throw std::system_error(errno, std::generic_category(), settings_.socket);
  }
}

void MetricsEndpoint::publish(std::string_view text) {
  text_ = text;
  if (!settings_.file.empty()) error_number_ = write_file();
}

/// @return the kernel's error, or 0
int MetricsEndpoint::write_file() const {
  constexpr mode_t kReadable = 0644;
  // A link or a FIFO of that name must neither lead elsewhere nor hold up the thread.
  constexpr int kWriteAnew = O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  const Descriptor file{::open(file_while_written_.c_str(), kWriteAnew, kReadable)};
  if (!file.is_open()) return errno;
  const ssize_t written = ::write(file.get(), text_.data(), text_.size());
  if (written < 0) return errno;
  if (written != static_cast<ssize_t>(text_.size())) return ENOSPC;
  return std::rename(file_while_written_.c_str(), settings_.file.c_str()) == 0 ? 0 : errno;
}

void MetricsEndpoint::serve() const {
  // Not all that there are: under a flood there is always one more.
  constexpr int kMostReaders = 16;
  for (int i = 0; i < kMostReaders; ++i) {
    const Descriptor reader{
        accept4(listener_->descriptor(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)};
    if (!reader.is_open()) return;
    (void)!::send(reader.get(), text_.data(), text_.size(), MSG_NOSIGNAL);
  }
}

}  // namespace zerorate::linux_node
