/// @file
/// Messages that other programs and the vehicle send: by CAN, UDP or a Unix socket.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "firmware/boards/linux/outputs/sink_settings.hpp"
#include "hal/contract/bus_error.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/linux/named_socket.hpp"

namespace zerorate::linux_node {

/// A signal of a CAN bus, in the figures of a DBC file.
struct CanSignal {
  std::string interface;
  std::uint32_t id = 0;  ///< identifier; bit 31 marks an extended frame, like in a DBC file
  unsigned start_bit = 0;
  unsigned length = 0;
  bool is_big_endian = false;  ///< `@0` of the DBC file; then start_bit is the highest bit
  bool is_signed = false;
  double scale = 1.0;  ///< value of one count
  double offset = 0.0;

  /// Bytes that a frame has to have; 0 where the signal does not fit into eight.
  [[nodiscard]] std::size_t bytes() const;
};

/// Whole frames of a CAN bus, of whose signals the receiver takes several.
struct CanFrames {
  std::string interface;
  std::vector<std::uint32_t> ids;  ///< like CanSignal::id
};

/// One frame of CanFrames.
struct CanFrame {
  std::uint32_t id = 0;  ///< like CanSignal::id
  std::span<const std::uint8_t> payload;
};

using MessageOrigin = std::variant<CanSignal, CanFrames, UdpSettings, UnixSettings>;

/// For the log: "can:can0 id 0x1a0", "can:can0 ids 0x1a0, 0x1a1", "udp:127.0.0.1:4000".
[[nodiscard]] std::string name_of(const MessageOrigin& origin);

/// Count of a signal in the payload of a CAN frame, without sign, scale and offset; nullopt where
/// the frame is too short.
[[nodiscard]] std::optional<std::uint64_t> raw_signal(const CanSignal& signal,
                                                      std::span<const std::uint8_t> payload);
/// Value that the payload of a CAN frame holds; nullopt where the frame is too short.
[[nodiscard]] std::optional<double> decode_signal(const CanSignal& signal,
                                                  std::span<const std::uint8_t> payload);
/// A finite decimal number; nullopt for anything else.
[[nodiscard]] std::optional<double> decode_number(std::string_view text);
/// Text without the white space around it.
[[nodiscard]] std::string_view trimmed(std::string_view text);
/// Takes the first word off a trimmed text, and the white space behind it.
[[nodiscard]] std::string_view take_word(std::string_view& text);

/// Value of a signal, whole frame, or text of a datagram. Text that is empty: a frame without the
/// signal.
using Message = std::variant<double, CanFrame, std::string_view>;

/// A socket that is opened at the first use, and tried again each second.
class MessageSource {
 public:
  using Buffer = std::array<std::uint8_t, 256>;

  explicit MessageSource(MessageOrigin origin) : origin_(std::move(origin)) {}

  /// Opens the socket where it is not open.
  /// @return whether it is open
  bool open(core::Instant now);
  /// The next message that waits, in the buffer; nullopt where none does. After an error, such as
  /// ENETDOWN, the socket is opened anew.
  core::Result<std::optional<Message>, hal::BusError> next(Buffer& buffer);
  /// Becomes readable when there is a message, for poll(); -1 while the socket is not open.
  [[nodiscard]] int descriptor() const;
  /// Reason of the newest failure, as the kernel gave it.
  [[nodiscard]] int error_number() const { return error_number_; }

 private:
  bool open_can(const std::string& name, std::span<const std::uint32_t> ids);
  bool open_udp(const UdpSettings& udp);
  [[nodiscard]] Message decode(std::span<const std::uint8_t> bytes);

  MessageOrigin origin_;
  std::array<std::uint8_t, 8> payload_{};  ///< payload of the newest frame
  hal::linux_os::Descriptor socket_;
  std::optional<hal::linux_os::NamedSocket> named_socket_;
  std::optional<core::Instant> tried_at_;
  int error_number_ = 0;
};

}  // namespace zerorate::linux_node
