#include "firmware/boards/linux/message_source.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <system_error>

namespace zerorate::linux_node {
namespace {

using hal::linux_os::Descriptor;

constexpr unsigned kByteBits = 8;
constexpr std::size_t kLongestPayload = 8;

/// Number of the bit that follows on the way from the highest to the lowest one in Motorola order:
/// from bit 0 of a byte to bit 7 of the next.
constexpr unsigned next_lower(unsigned bit) {
  return bit % kByteBits == 0 ? bit + 2 * kByteBits - 1 : bit - 1;
}

struct NameOrigin {
  std::string operator()(const CanSignal& signal) const {
    return fmt::format("can:{} id {:#x}", signal.interface, signal.id);
  }
  std::string operator()(const CanFrames& frames) const {
    return fmt::format("can:{} id{} {:#x}", frames.interface, frames.ids.size() == 1 ? "" : "s",
                       fmt::join(frames.ids, ", "));
  }
  std::string operator()(const UdpSettings& udp) const {
    return fmt::format("udp:{}:{}", udp.address, udp.port);
  }
  std::string operator()(const UnixSettings& local) const { return "unix:" + local.path; }
};

}  // namespace

std::size_t CanSignal::bytes() const {
  if (length == 0 || length > kLongestPayload * kByteBits) return 0;
  unsigned last = start_bit;
  for (unsigned i = 1; i < length; ++i) last = is_big_endian ? next_lower(last) : last + 1;
  const std::size_t needed = last / kByteBits + 1;
  return needed <= kLongestPayload ? needed : 0;
}

std::string name_of(const MessageOrigin& origin) {
  return std::visit(NameOrigin{}, origin);
}

std::optional<std::uint64_t> raw_signal(const CanSignal& signal,
                                        std::span<const std::uint8_t> payload) {
  if (signal.bytes() == 0 || payload.size() < signal.bytes()) return std::nullopt;
  std::uint64_t raw = 0;
  unsigned bit = signal.start_bit;
  for (unsigned i = 0; i < signal.length; ++i) {
    const std::uint64_t value = payload[bit / kByteBits] >> (bit % kByteBits) & 1U;
    raw = signal.is_big_endian ? raw << 1U | value : raw | value << i;
    bit = signal.is_big_endian ? next_lower(bit) : bit + 1;
  }
  return raw;
}

std::optional<double> decode_signal(const CanSignal& signal,
                                    std::span<const std::uint8_t> payload) {
  const auto counts = raw_signal(signal, payload);
  if (!counts) return std::nullopt;
  const std::uint64_t raw = *counts;
  const std::uint64_t sign = std::uint64_t{1} << (signal.length - 1);
  const bool is_negative = signal.is_signed && (raw & sign) != 0;
  // Two's complement: the sign's bit counts negatively.
  const double value = is_negative ? static_cast<double>(raw - sign) - static_cast<double>(sign)
                                   : static_cast<double>(raw);
  return value * signal.scale + signal.offset;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size()));
  return text.substr(0, text.find_last_not_of(kSpace) + 1);
}

std::string_view take_word(std::string_view& text) {
  const std::string_view word = text.substr(0, text.find_first_of(" \t\r\n"));
  text = trimmed(text.substr(word.size()));
  return word;
}

std::optional<double> decode_number(std::string_view text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

core::Result<std::optional<Message>, hal::BusError> MessageSource::next(Buffer& buffer) {
  const ssize_t size = recv(descriptor(), buffer.data(), buffer.size(), MSG_DONTWAIT);
  if (size >= 0) {
    return std::optional{decode(std::span{buffer}.first(static_cast<std::size_t>(size)))};
  }
  if (errno == EAGAIN || errno == EINTR) return std::optional<Message>{};
  error_number_ = errno;
  socket_.reset(-1);
  return core::Unexpected{hal::BusError::io};
}

int MessageSource::descriptor() const {
  return named_socket_ ? named_socket_->descriptor() : socket_.get();
}

bool MessageSource::open(core::Instant now) {
  if (descriptor() >= 0) return true;
  if (tried_at_ && now - *tried_at_ < core::Duration::seconds(1)) return false;
  tried_at_ = now;
  if (const auto* const can = std::get_if<CanSignal>(&origin_)) {
    return open_can(can->interface, std::span{&can->id, 1});
  }
  if (const auto* const can = std::get_if<CanFrames>(&origin_)) {
    return open_can(can->interface, can->ids);
  }
  if (const auto* const udp = std::get_if<UdpSettings>(&origin_)) return open_udp(*udp);
  try {
    named_socket_.emplace(std::get<UnixSettings>(origin_).path, SOCK_DGRAM);
  } catch (const std::system_error& error) {
    error_number_ = error.code().value();
    return false;
  }
  return true;
}

bool MessageSource::open_can(const std::string& name, std::span<const std::uint32_t> ids) {
  Descriptor opened{socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW)};
  ifreq interface = hal::linux_os::interface_request(name);
  bool is_open = opened.is_open() && ioctl(opened.get(), SIOCGIFINDEX, &interface) == 0;
  if (is_open) {
    std::vector<can_filter> filters;
    for (const std::uint32_t id : ids) {
      const bool is_extended = (id & CAN_EFF_FLAG) != 0;
      filters.push_back(
          {.can_id = id,
           .can_mask = CAN_EFF_FLAG | CAN_RTR_FLAG | (is_extended ? CAN_EFF_MASK : CAN_SFF_MASK)});
    }
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = interface.ifr_ifindex;
    is_open = setsockopt(opened.get(), SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                         static_cast<socklen_t>(filters.size() * sizeof(can_filter))) == 0 &&
              bind(opened.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  if (!is_open) error_number_ = errno;
  if (is_open) socket_ = std::move(opened);
  return is_open;
}

bool MessageSource::open_udp(const UdpSettings& udp) {
  const auto address = hal::linux_os::udp_address(udp.address, udp.port);
  Descriptor opened{
      socket(address.storage.ss_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
  const bool is_open = opened.is_open() && bind(opened.get(), address.get(), address.size) == 0;
  if (!is_open) error_number_ = errno;
  if (is_open) socket_ = std::move(opened);
  return is_open;
}

Message MessageSource::decode(std::span<const std::uint8_t> bytes) {
  const auto* const signal = std::get_if<CanSignal>(&origin_);
  if (signal == nullptr && !std::holds_alternative<CanFrames>(origin_)) {
    return std::string_view{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  can_frame frame{};
  if (bytes.size() != sizeof frame) return std::string_view{};
  std::memcpy(&frame, bytes.data(), sizeof frame);
  std::ranges::copy(frame.data, payload_.begin());
  const auto payload =
      std::span{payload_}.first(std::min<std::size_t>(frame.can_dlc, kLongestPayload));
  if (signal == nullptr) return CanFrame{.id = frame.can_id, .payload = payload};
  const auto value = decode_signal(*signal, payload);
  return value ? Message{*value} : Message{std::string_view{}};
}

}  // namespace zerorate::linux_node
