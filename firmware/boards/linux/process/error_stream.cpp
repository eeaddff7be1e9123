#include "firmware/boards/linux/process/error_stream.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

namespace zerorate::linux_node {

void ErrorStream::write_line(std::string_view line, core::Instant now) {
  std::string text{line};
  if (Recent* const known = find(line)) {
    if (now - known->at < kOncePer) {
      ++known->left_out;
      return;
    }
    if (known->left_out > 0) text += fmt::format(" ({} times more meanwhile)", known->left_out);
    known->at = now;
    known->left_out = 0;
  } else {
    remember(line, now);
  }
  if (lost_untold_ > 0 && write(fmt::format("{} lines of this log were lost", lost_untold_))) {
    lost_untold_ = 0;
  }
  if (write(std::move(text))) return;
  ++lost_;
  ++lost_untold_;
}

ErrorStream::Recent* ErrorStream::find(std::string_view line) {
  const auto known = std::ranges::find(recent_, line, &Recent::line);
  return known != recent_.end() ? &*known : nullptr;
}

void ErrorStream::remember(std::string_view line, core::Instant now) {
  recent_.at(next_) = {.line = std::string{line}, .at = now, .left_out = 0};
  next_ = (next_ + 1) % recent_.size();
}

/// A pipe that is writable takes up to PIPE_BUF bytes whole and at once (POSIX); of a socket, such
/// as the journal's, the kernel is asked not to wait.
bool ErrorStream::write(std::string text) const {
  constexpr std::size_t kLongest = 4000;  // with the name of the program below PIPE_BUF
  if (text.size() > kLongest) text.resize(kLongest);
  text = "zerorated: " + text + '\n';
  pollfd ready{.fd = descriptor_, .events = POLLOUT, .revents = 0};
  if (poll(&ready, 1, 0) != 1 || (ready.revents & POLLOUT) == 0) return false;
  ssize_t written = send(descriptor_, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (written < 0 && errno == ENOTSOCK) written = ::write(descriptor_, text.data(), text.size());
  return written == static_cast<ssize_t>(text.size());
}

void keep_standard_descriptors() {
  for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor) {
    if (fcntl(descriptor, F_GETFD) == 0 || errno != EBADF) continue;
    (void)!::open("/dev/null", O_RDWR);  // takes the lowest number that is free, which is this one
  }
}

}  // namespace zerorate::linux_node
