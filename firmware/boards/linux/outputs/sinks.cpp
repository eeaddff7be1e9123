#include "firmware/boards/linux/outputs/sinks.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <optional>
#include <span>
#include <system_error>

#include "firmware/boards/linux/outputs/can_sink.hpp"
#include "firmware/boards/linux/outputs/json_line.hpp"
#include "firmware/boards/linux/outputs/retry_counter.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/linux/named_socket.hpp"

namespace zerorate::linux_node {
namespace {

using hal::linux_os::checked_descriptor;
using hal::linux_os::Descriptor;

/// JSON lines to a file, a terminal or a pipe. A FIFO's reader may come, go and come again. What
/// was learnt is a member of the next line, so that every line is a message.
class JsonSink final : public Sink {
 public:
  JsonSink(const JsonSettings& settings, std::string_view node)
      : Sink(name_of(settings)), file_(settings.file), node_(node) {
    (void)open();
  }

  void publish_learnt(const wire::LearntModel& learnt) override { learnt_ = learnt; }

 private:
  /// Never waits: a FIFO without a reader is ENXIO.
  bool open() {
    constexpr mode_t kReadable = 0644;
    constexpr int kFlags = O_WRONLY | O_CREAT | O_APPEND | O_NONBLOCK | O_NOCTTY | O_CLOEXEC;
    output_ =
        Descriptor{file_ == "-" ? dup(STDOUT_FILENO) : ::open(file_.c_str(), kFlags, kReadable)};
    if (!output_.is_open()) keep_reason();
    return output_.is_open();
  }

  bool send(const wire::NumberedMessage& message) override {
    if (!output_.is_open() && !(retry_.is_due() && open())) return false;
    // A pipe that is writable takes a line of less than PIPE_BUF bytes whole and at once (POSIX).
    pollfd ready{.fd = output_.get(), .events = POLLOUT, .revents = 0};
    if (poll(&ready, 1, 0) != 1 || (ready.revents & POLLOUT) == 0) {
      keep_reason(EAGAIN);
      return false;
    }
    const std::string_view line =
        format_json_line(message, buffer_, node_, learnt_ ? &*learnt_ : nullptr);
    const ssize_t written = ::write(output_.get(), line.data(), line.size());
    if (written == static_cast<ssize_t>(line.size())) {
      learnt_.reset();
      return true;
    }
    if (written < 0) return keep_reason(), false;
    keep_reason(ENOSPC);  // a part of the line found room
    take_back(written);
    return false;
  }

  /// Removes the beginning of a line whose rest found no room on the disk. Does nothing to a pipe.
  void take_back(ssize_t bytes) const {
    const off_t end = lseek(output_.get(), 0, SEEK_END);
    if (end >= bytes) (void)!ftruncate(output_.get(), end - bytes);
  }

  std::string file_;
  std::string node_;
  Descriptor output_;
  RetryCounter retry_;
  std::optional<wire::LearntModel> learnt_;  ///< not yet sent
  JsonBuffer buffer_{};
};

/// Rate frames, and those of what was learnt, to one address. Unconnected, so that a receiver may
/// come, go and come again.
class DatagramSink final : public Sink {
 public:
  DatagramSink(std::string name, const hal::linux_os::SocketAddress& to)
      : Sink(std::move(name)),
        socket_(checked_descriptor(
            socket(to.storage.ss_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0), "socket")),
        to_(to) {}

  void publish_learnt(const wire::LearntModel& learnt) override {
    (void)send_frame(wire::encode_learnt_frame(learnt));
  }

 private:
  bool send(const wire::NumberedMessage& message) override {
    const wire::RateFrame frame = wire::encode_rate_frame(message);
    return send_frame(frame.bytes());
  }
  bool send_frame(std::span<const std::uint8_t> frame) {
    const ssize_t sent =
        sendto(socket_.get(), frame.data(), frame.size(), MSG_NOSIGNAL, to_.get(), to_.size);
    if (sent != static_cast<ssize_t>(frame.size())) keep_reason();
    return sent == static_cast<ssize_t>(frame.size());
  }

  Descriptor socket_;
  hal::linux_os::SocketAddress to_;
};

struct NameSink {
  std::string operator()(const JsonSettings& json) const { return "json:" + json.file; }
  std::string operator()(const UdpSettings& udp) const {
    return fmt::format("udp:{}:{}", udp.address, udp.port);
  }
  std::string operator()(const UnixSettings& local) const { return "unix:" + local.path; }
  std::string operator()(const CanSettings& can) const { return "can:" + can.interface; }
};

struct MakeSink {
  std::string_view node;

  std::unique_ptr<Sink> operator()(const JsonSettings& json) const {
    return std::make_unique<JsonSink>(json, node);
  }
  std::unique_ptr<Sink> operator()(const UdpSettings& udp) const {
    return std::make_unique<DatagramSink>(name_of(udp),
                                          hal::linux_os::udp_address(udp.address, udp.port));
  }
  std::unique_ptr<Sink> operator()(const UnixSettings& local) const {
    return std::make_unique<DatagramSink>(name_of(local), hal::linux_os::unix_address(local.path));
  }
  std::unique_ptr<Sink> operator()(const CanSettings& can) const { return make_can_sink(can); }
};

}  // namespace

std::string name_of(const SinkSettings& settings) {
  return std::visit(NameSink{}, settings);
}

std::unique_ptr<Sink> make_sink(const SinkSettings& settings, std::string_view node) {
  return std::visit(MakeSink{node}, settings);
}

}  // namespace zerorate::linux_node
