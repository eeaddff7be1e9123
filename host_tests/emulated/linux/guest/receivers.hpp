/// @file
/// The other ways out of zerorated: UDP, CAN, JSON lines.
#pragma once

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/wire/learnt_frame.hpp"
#include "firmware/wire/rate_frame.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/linux/named_socket.hpp"
#include "host_tests/emulated/linux/guest/device_world.hpp"
#include "host_tools/lib/live/source.hpp"

namespace zerorate::emulated {

inline constexpr const char* kJsonFile = "/run/rate.jsonl";
inline constexpr const char* kCanInterface = "vcan0";
inline constexpr std::uint16_t kUdpPort = 24680;

/// Rates decoded with firmware/wire/zerorate.dbc, in 1e-6 deg/s.
struct CanMessage {
  std::array<double, 3> rate_dps{};
  std::array<double, 3> bias_dps{};
};

/// Keeps all that comes.
class Receivers {
 public:
  Receivers() {
    (void)unlink(kJsonFile);
    open_udp();
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(if_nametoindex(kCanInterface));
    if (bind(can_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      give_up(kCanInterface);
    }
  }

  void open_udp() {
    udp_.reset(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    const auto address = hal::linux_os::udp_address("127.0.0.1", kUdpPort);
    if (bind(udp_.get(), address.get(), address.size) != 0) give_up("udp");
  }
  void close_udp() { udp_.reset(-1); }

  void receive() {
    receive_udp();
    receive_can();
  }

  [[nodiscard]] const std::vector<wire::NumberedMessage>& udp() const { return udp_messages_; }
  [[nodiscard]] const std::vector<CanMessage>& can() const { return can_messages_; }
  [[nodiscard]] static std::vector<wire::NumberedMessage> json() {
    std::vector<wire::NumberedMessage> messages;
    std::ifstream file{kJsonFile};
    for (std::string line; std::getline(file, line);) {
      const auto message = live::parse_json_message(line);
      if (!message) give_up("a line that is no message");
      messages.push_back(message->message);
    }
    return messages;
  }

 private:
  void receive_udp() {
    std::array<std::uint8_t, wire::kMostRateFrameBytes> bytes{};
    for (;;) {
      const ssize_t size = recv(udp_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
      if (size < 0) return;
      const auto datagram = std::span{bytes}.first(static_cast<std::size_t>(size));
      if (wire::decode_learnt_frame(datagram)) continue;
      const auto frame = wire::decode_rate_frame(datagram);
      if (!frame) give_up("a datagram that is no frame");
      udp_messages_.push_back(*frame);
    }
  }

  /// x, y, z, and then the status, which makes the three valid.
  void receive_can() {
    can_frame frame{};
    while (recv(can_.get(), &frame, sizeof frame, MSG_DONTWAIT) == sizeof frame) {
      if (frame.can_id == 0x200) {
        can_messages_.push_back(axes_);
      } else if (frame.can_id >= 0x201 && frame.can_id <= 0x203) {
        axes_.rate_dps.at(frame.can_id - 0x201U) = number(frame, 0) * 1e-6;
        // 28 bits with a sign below the counter.
        axes_.bias_dps.at(frame.can_id - 0x201U) = ((number(frame, 4) << 4) >> 4) * 1e-6;
      }
    }
  }

  static std::int32_t number(const can_frame& frame, std::size_t at) {
    std::uint32_t bits = 0;
    for (std::size_t i = 4; i > 0; --i) bits = bits << 8U | frame.data[at + i - 1];
    return std::bit_cast<std::int32_t>(bits);
  }

  hal::linux_os::Descriptor udp_;
  hal::linux_os::Descriptor can_{socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW)};
  std::vector<wire::NumberedMessage> udp_messages_;
  std::vector<CanMessage> can_messages_;
  CanMessage axes_;
};

}  // namespace zerorate::emulated
