#include "firmware/boards/linux/outputs/sinks.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <span>
#include <system_error>

#include "firmware/boards/linux/outputs/json_line.hpp"
#include "firmware/wire/can_frames.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/linux/named_socket.hpp"

namespace zerorate::linux_node {
namespace {

using hal::linux_os::checked_descriptor;
using hal::linux_os::Descriptor;

/// Messages between two attempts to open what was not there, such as a FIFO's reader.
constexpr int kRetryAfter = 100;

/// Says when to try again.
class RetryCounter {
 public:
  bool is_due() {
    if (++waited_ < kRetryAfter) return false;
    waited_ = 0;
    return true;
  }

 private:
  int waited_ = 0;
};

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

/// CAN frames through SocketCAN, rates only. The interface may be absent or down, at the start and
/// later.
class CanSink final : public Sink {
 public:
  explicit CanSink(const CanSettings& settings)
      : Sink(name_of(settings)),
        id_(settings.id),
        interface_(hal::linux_os::interface_request(settings.interface)) {
    (void)open();
  }

 private:
  bool open() {
    const bool is_open = try_to_open();
    if (!is_open) keep_reason();
    return is_open;
  }
  bool try_to_open() {
    Descriptor opened{socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW)};
    if (!opened.is_open() || ioctl(opened.get(), SIOCGIFINDEX, &interface_) != 0) return false;
    // Frames of others are not read: without this they would fill the socket's buffer.
    (void)setsockopt(opened.get(), SOL_CAN_RAW, CAN_RAW_FILTER, nullptr, 0);
    const can_err_mask_t states = CAN_ERR_BUSOFF | CAN_ERR_RESTARTED;
    (void)setsockopt(opened.get(), SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &states, sizeof states);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = interface_.ifr_ifindex;
    if (bind(opened.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      return false;
    }
    socket_ = std::move(opened);
    is_bus_off_ = false;
    return true;
  }

  /// The controller takes no part in the bus after too many errors. The kernel tells it by error
  /// frames, and says to write() all the same that it has taken the frame. An interface that was
  /// set down and up again takes part without a frame that says so: the error ENETDOWN, which the
  /// kernel gives once and before frames that are older, is the only trace.
  void take_states() {
    constexpr int kMostFrames = 64;
    bool was_down = false;
    for (int i = 0; i < kMostFrames; ++i) {
      can_frame frame{};
      const ssize_t size = recv(socket_.get(), &frame, sizeof frame, MSG_DONTWAIT);
      if (size == sizeof frame) {
        is_bus_off_ = is_bus_off_after(frame.can_id, is_bus_off_);
      } else if (size < 0 && errno == ENETDOWN) {
        was_down = true;
      } else {
        break;
      }
    }
    if (was_down) is_bus_off_ = false;
  }

  bool send(const wire::NumberedMessage& message) override {
    if (!socket_.is_open() && !(retry_.is_due() && open())) return false;
    take_states();
    if (is_bus_off_) {
      keep_reason(ECOMM);
      return false;
    }
    if (!write_frames(wire::encode_can_frames(message, id_))) return false;
    return send_turn(message) && send_vertical(message) && send_acceleration(message) &&
           send_inputs(message);
  }

  bool send_turn(const wire::NumberedMessage& message) {
    if (message.sequence % wire::kCanTurnEvery != 0) return true;
    return write_frames(wire::encode_can_turn(message.message, id_));
  }
  bool send_vertical(const wire::NumberedMessage& message) {
    return message.sequence % wire::kCanTurnEvery != 0 || !message.message.up ||
           (write_frame(wire::encode_can_vertical(message.message, id_)) &&
            write_frame(wire::encode_can_up(message.message, id_)) &&
            write_frame(wire::encode_can_vertical_turn(message.message, id_)));
  }
  bool send_acceleration(const wire::NumberedMessage& message) {
    const bool has_any = message.message.acceleration || message.message.vibration;
    return message.sequence % wire::kCanTurnEvery != 0 || !has_any ||
           write_frame(wire::encode_can_acceleration(message.message, id_));
  }
  bool send_inputs(const wire::NumberedMessage& message) {
    if (message.sequence % wire::kCanInputsEvery != 0) return true;
    if (!write_frame(wire::encode_can_inputs(message.message, id_))) return false;
    return !message.message.explained ||
           write_frames(wire::encode_can_explained(message.message, id_));
  }

  bool write_frames(std::span<const wire::CanFrame> frames) {
    return std::ranges::all_of(frames,
                               [&](const wire::CanFrame& frame) { return write_frame(frame); });
  }
  bool write_frame(const wire::CanFrame& frame) {
    can_frame out{};
    out.can_id = frame.id;
    out.can_dlc = CAN_MAX_DLEN;
    std::ranges::copy(frame.data, std::begin(out.data));
    if (write(socket_.get(), &out, sizeof out) == static_cast<ssize_t>(sizeof out)) return true;
    keep_reason();
    // Down (ENETDOWN) or full (ENOBUFS, EAGAIN) passes; a removed interface needs a new socket.
    if (errno == ENODEV || errno == ENXIO) socket_.reset(-1);
    return false;
  }

  std::uint16_t id_;
  ifreq interface_;  // the kernel answers in it
  Descriptor socket_;
  RetryCounter retry_;
  bool is_bus_off_ = false;
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
  std::unique_ptr<Sink> operator()(const CanSettings& can) const {
    return std::make_unique<CanSink>(can);
  }
};

}  // namespace

bool is_bus_off_after(std::uint32_t can_id, bool is_bus_off) {
  if ((can_id & CAN_ERR_FLAG) == 0) return is_bus_off;
  if ((can_id & CAN_ERR_RESTARTED) != 0) return false;
  return is_bus_off || (can_id & CAN_ERR_BUSOFF) != 0;
}

std::string name_of(const SinkSettings& settings) {
  return std::visit(NameSink{}, settings);
}

std::unique_ptr<Sink> make_sink(const SinkSettings& settings, std::string_view node) {
  return std::visit(MakeSink{node}, settings);
}

}  // namespace zerorate::linux_node
