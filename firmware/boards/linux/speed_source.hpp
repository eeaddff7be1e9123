/// @file
/// A vehicle's speed, or its word that it stands, from CAN, UDP or a Unix socket, as an odometer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "firmware/boards/linux/outputs/sink_settings.hpp"
#include "hal/contract/pulse_input.hpp"
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
  double scale_mps = 1.0;
  double offset_mps = 0.0;

  /// Bytes that a frame has to have; 0 where the signal does not fit into eight.
  [[nodiscard]] std::size_t bytes() const;
};

/// Where messages of the speed come from.
using SpeedOrigin = std::variant<CanSignal, UdpSettings, UnixSettings>;

struct SpeedSettings {
  SpeedOrigin origin;
  double dead_band_mps = 0.0;  ///< a greater speed, forwards or backwards, is motion
  core::Duration timeout;      ///< without a message for so long, nothing is known
};

/// For the log: "can:can0 id 0x1a0", "udp:127.0.0.1:4000".
[[nodiscard]] std::string name_of(const SpeedOrigin& origin);

/// Speed in m/s that the payload of a CAN frame holds; nullopt where the frame is too short.
[[nodiscard]] std::optional<double> decode_signal(const CanSignal& signal,
                                                  std::span<const std::uint8_t> payload);
/// Speed in m/s that a datagram states: a decimal number, `still` (0) or `moving` (infinite). White
/// space around it does not count. nullopt for anything else.
[[nodiscard]] std::optional<double> decode_text(std::string_view text);

/// A PulseInput: each message of a speed beyond the dead band is a pulse, stamped when it is read.
/// Silence is no standstill: without a message for the timeout, and where the socket cannot be
/// opened, reading fails and the vehicle counts as moving. A socket is opened at the first use, and
/// tried again each second.
class SpeedSource {
 public:
  explicit SpeedSource(SpeedSettings settings) : settings_(std::move(settings)) {}

  core::Result<hal::PulseBatch, hal::BusError> read_pulses(std::span<core::Instant> stamps);
  /// Becomes readable when there is a message, for poll(); -1 while the socket is not open.
  [[nodiscard]] int descriptor() const;
  /// Reason of the newest failure, as the kernel gave it.
  [[nodiscard]] int error_number() const { return error_number_; }

 private:
  bool open(core::Instant now);
  bool open_can(const CanSignal& signal);
  bool open_udp(const UdpSettings& udp);
  [[nodiscard]] std::optional<double> decode(std::span<const std::uint8_t> message) const;

  SpeedSettings settings_;
  hal::linux_os::Descriptor socket_;
  std::optional<hal::linux_os::NamedSocket> named_socket_;
  std::optional<core::Instant> tried_at_;
  std::optional<core::Instant> heard_at_;
  int error_number_ = 0;
};
static_assert(hal::PulseInput<SpeedSource>);

}  // namespace zerorate::linux_node
