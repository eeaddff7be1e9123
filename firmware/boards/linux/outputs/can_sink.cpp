#include "firmware/boards/linux/outputs/can_sink.hpp"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <span>
#include <utility>

#include "firmware/boards/linux/outputs/retry_counter.hpp"
#include "firmware/wire/can_frames.hpp"
#include "firmware/wire/can_protected.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/linux/named_socket.hpp"

namespace zerorate::linux_node {
namespace {

using hal::linux_os::Descriptor;

/// Rates and what belongs to them; what was learnt has no frame.
class CanSink final : public Sink {
 public:
  explicit CanSink(const CanSettings& settings)
      : Sink(name_of(settings), settings.every),
        settings_(settings),
        interface_(hal::linux_os::interface_request(settings.interface)) {
    (void)open();
  }

 private:
  static bool enable_fd(const Descriptor& socket) {
    const int on = 1;
    return setsockopt(socket.get(), SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on) == 0;
  }
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
    if (settings_.layout == CanLayout::fd && !enable_fd(opened)) return false;
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
    // Counts what does not reach the bus, too: a receiver sees by the gap that something is lost.
    const wire::NumberedMessage numbered{.sequence = next_++, .message = message.message};
    if (!socket_.is_open() && !(retry_.is_due() && open())) return false;
    take_states();
    if (is_bus_off_) {
      keep_reason(ECOMM);
      return false;
    }
    switch (settings_.layout) {
      case CanLayout::yaw:
        return write_frame(wire::encode_can_yaw(numbered, settings_.id, settings_.e2e));
      case CanLayout::fd:
        return write_fd_frame(wire::encode_can_fd(numbered, settings_.id, settings_.e2e)) &&
               send_slow_frames(numbered);
      case CanLayout::axes:
        return write_frames(wire::encode_can_frames(numbered, settings_.id)) &&
               send_slow_frames(numbered);
    }
    return false;
  }

  bool send_slow_frames(const wire::NumberedMessage& numbered) {
    const bool sends_turn = numbered.sequence % wire::kCanTurnEvery == 0;
    const bool sends_inputs = numbered.sequence % wire::kCanInputsEvery == 0;
    return (!sends_turn || send_turn(numbered)) && (!sends_inputs || send_inputs(numbered));
  }
  bool send_turn(const wire::NumberedMessage& numbered) {
    const app::RateMessage& message = numbered.message;
    const std::uint16_t id = settings_.id;
    if (!write_frames(wire::encode_can_turn(numbered, id))) return false;
    if (message.up && !(write_frame(wire::encode_can_vertical(numbered, id)) &&
                        write_frame(wire::encode_can_up(numbered, id)) &&
                        write_frame(wire::encode_can_vertical_turn(numbered, id)))) {
      return false;
    }
    const bool has_acceleration = message.acceleration || message.vibration;
    return !has_acceleration || write_frame(wire::encode_can_acceleration(numbered, id));
  }
  bool send_inputs(const wire::NumberedMessage& numbered) {
    if (!write_frame(wire::encode_can_inputs(numbered, settings_.id))) return false;
    return !numbered.message.explained ||
           write_frames(wire::encode_can_explained(numbered, settings_.id));
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
    return write_whole(out);
  }
  bool write_fd_frame(const wire::CanFdFrame& frame) {
    canfd_frame out{};
    out.can_id = frame.id;
    out.len = static_cast<std::uint8_t>(frame.data.size());
    out.flags = CANFD_BRS;  // the data at the second bit rate, where the interface has one
    std::ranges::copy(frame.data, std::begin(out.data));
    return write_whole(out);
  }
  template <class Frame>
  bool write_whole(const Frame& frame) {
    if (write(socket_.get(), &frame, sizeof frame) == static_cast<ssize_t>(sizeof frame)) {
      return true;
    }
    keep_reason();
    // Down (ENETDOWN) or full (ENOBUFS, EAGAIN) passes; a removed interface needs a new socket.
    if (errno == ENODEV || errno == ENXIO) socket_.reset(-1);
    return false;
  }

  CanSettings settings_;
  ifreq interface_;  // the kernel answers in it
  Descriptor socket_;
  RetryCounter retry_;
  bool is_bus_off_ = false;
  std::uint32_t next_ = 0;  ///< number of the next message on this bus
};

}  // namespace

bool is_bus_off_after(std::uint32_t can_id, bool is_bus_off) {
  if ((can_id & CAN_ERR_FLAG) == 0) return is_bus_off;
  if ((can_id & CAN_ERR_RESTARTED) != 0) return false;
  return is_bus_off || (can_id & CAN_ERR_BUSOFF) != 0;
}

std::unique_ptr<Sink> make_can_sink(const CanSettings& settings) {
  return std::make_unique<CanSink>(settings);
}

}  // namespace zerorate::linux_node
