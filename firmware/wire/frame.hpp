/// @file
/// What the node says, as bytes: rate messages and the counters of its loop, in frames that carry
/// their kind, version, number and checksum. docs/reference/wire-format.md is the table of bytes.
///
/// A frame has no length and no delimiter of its own: a datagram gives them on Linux, COBS
/// (cobs.hpp) on a serial line.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/crc32.hpp"
#include "core/base/result.hpp"
#include "firmware/app/node_loop.hpp"
#include "firmware/app/rate_message.hpp"
#include "firmware/wire/bytes.hpp"

namespace zerorate::wire {

/// Raised with every change of a layout. A reader refuses what it does not know.
inline constexpr std::uint8_t kVersion = 1;

enum class FrameKind : std::uint8_t {
  rate = 0x52,    ///< 'R': one app::RateMessage
  status = 0x53,  ///< 'S': one StatusReport
};

enum class FrameError : std::uint8_t {
  wrong_length,     ///< not as long as a frame of its kind
  corrupt,          ///< the checksum, or a value that no node writes
  unknown_kind,     ///< intact, but of another kind
  unknown_version,  ///< intact, but of another version
};

/// What has happened to the node so far; sent now and then.
struct StatusReport {
  app::LoopCounters counters;
  std::uint32_t frames_dropped = 0;  ///< for which the line had no room

  constexpr bool operator==(const StatusReport&) const = default;
};

/// A message with its number. The numbers count all frames of a node: a gap is a loss.
template <class Message>
struct Numbered {
  std::uint32_t number = 0;
  Message message;
};

namespace detail {

inline constexpr std::size_t kHeaderBytes = 2 + sizeof(std::uint32_t);
inline constexpr std::size_t kChecksumBytes = sizeof(std::uint32_t);
inline constexpr std::size_t kRateBytes = sizeof(std::int64_t) + 2 + 12 * sizeof(float);
inline constexpr std::size_t kStatusBytes = 10 * sizeof(std::uint32_t) + 3;

[[nodiscard]] constexpr std::uint8_t to_bits(const app::Health& health) {
  return static_cast<std::uint8_t>(
      (health.calibrated ? 1U : 0U) | (health.sample_refused ? 2U : 0U) |
      (health.time_refused ? 4U : 0U) | (health.saturated ? 8U : 0U) |
      (health.model_inconsistent ? 16U : 0U) | (health.pulses_lost ? 32U : 0U));
}

[[nodiscard]] constexpr app::Health to_health(std::uint8_t bits) {
  return {.calibrated = (bits & 1U) != 0,
          .sample_refused = (bits & 2U) != 0,
          .time_refused = (bits & 4U) != 0,
          .saturated = (bits & 8U) != 0,
          .model_inconsistent = (bits & 16U) != 0,
          .pulses_lost = (bits & 32U) != 0};
}

constexpr void put(ByteWriter& writer, const app::RateMessage& message) {
  writer.put(message.time.ns());
  writer.put(static_cast<std::uint8_t>(message.motion));
  writer.put(to_bits(message.health));
  for (const app::AxisRate& axis : message.axes) {
    for (const core::AngularRate rate : {axis.measured, axis.corrected, axis.bias, axis.sigma}) {
      writer.put(rate.in(core::rad_per_s));
    }
  }
}

constexpr void put(ByteWriter& writer, const StatusReport& report) {
  const app::LoopCounters& counters = report.counters;
  for (const std::uint32_t count :
       {counters.samples, counters.pulses, counters.pulses_lost, counters.odometer_errors,
        counters.starts, counters.start_errors, counters.read_errors, counters.overruns,
        counters.configurations_lost, report.frames_dropped}) {
    writer.put(count);
  }
  writer.put(static_cast<std::uint8_t>(counters.last_error.code));
  writer.put(static_cast<std::uint8_t>(counters.last_error.bus));
  writer.put(counters.last_error.reg);
}

template <std::size_t Size>
[[nodiscard]] constexpr std::array<std::uint8_t, Size> frame(FrameKind kind, std::uint32_t number,
                                                             const auto& message) {
  std::array<std::uint8_t, Size> bytes{};
  ByteWriter writer{bytes};
  writer.put(static_cast<std::uint8_t>(kind));
  writer.put(kVersion);
  writer.put(number);
  put(writer, message);
  writer.put(core::crc32(writer.written()));
  return bytes;
}

/// The frame's number, if the bytes are an intact frame of this kind and size.
[[nodiscard]] constexpr core::Result<std::uint32_t, FrameError> open(
    std::span<const std::uint8_t> bytes, FrameKind kind, std::size_t size) {
  if (bytes.size() < kHeaderBytes + kChecksumBytes) {
    return core::Unexpected{FrameError::wrong_length};
  }
  const auto content = bytes.first(bytes.size() - kChecksumBytes);
  ByteReader checksum{bytes.last(kChecksumBytes)};
  if (checksum.take<std::uint32_t>() != core::crc32(content)) {
    return core::Unexpected{FrameError::corrupt};
  }
  ByteReader header{content};
  if (header.take<std::uint8_t>() != static_cast<std::uint8_t>(kind)) {
    return core::Unexpected{FrameError::unknown_kind};
  }
  if (header.take<std::uint8_t>() != kVersion) return core::Unexpected{FrameError::unknown_version};
  if (bytes.size() != size) return core::Unexpected{FrameError::wrong_length};
  return header.take<std::uint32_t>();
}

}  // namespace detail

inline constexpr std::size_t kRateFrameBytes =
    detail::kHeaderBytes + detail::kRateBytes + detail::kChecksumBytes;
inline constexpr std::size_t kStatusFrameBytes =
    detail::kHeaderBytes + detail::kStatusBytes + detail::kChecksumBytes;
inline constexpr std::size_t kLongestFrame = std::max(kRateFrameBytes, kStatusFrameBytes);

/// Cost: two table look-ups a byte for the checksum. No rounding: the bits of every number are
/// sent.
[[nodiscard]] constexpr std::array<std::uint8_t, kRateFrameBytes> encode(
    const app::RateMessage& message, std::uint32_t number) {
  return detail::frame<kRateFrameBytes>(FrameKind::rate, number, message);
}
[[nodiscard]] constexpr std::array<std::uint8_t, kStatusFrameBytes> encode(
    const StatusReport& report, std::uint32_t number) {
  return detail::frame<kStatusFrameBytes>(FrameKind::status, number, report);
}

/// The rate message in a frame. Errors: see FrameError; a frame of another kind is unknown_kind.
[[nodiscard]] constexpr core::Result<Numbered<app::RateMessage>, FrameError> decode_rate(
    std::span<const std::uint8_t> bytes) {
  const auto number = detail::open(bytes, FrameKind::rate, kRateFrameBytes);
  if (!number) return core::Unexpected{number.error()};
  ByteReader reader{bytes.subspan(detail::kHeaderBytes)};
  Numbered<app::RateMessage> decoded{.number = *number, .message = {}};
  decoded.message.time = core::Instant::from_ns(reader.take_int64());
  const auto motion = reader.take<std::uint8_t>();
  const auto health = reader.take<std::uint8_t>();
  if (motion > static_cast<std::uint8_t>(core::Motion::still)) {
    return core::Unexpected{FrameError::corrupt};
  }
  decoded.message.motion = static_cast<core::Motion>(motion);
  decoded.message.health = detail::to_health(health);
  for (app::AxisRate& axis : decoded.message.axes) {
    for (core::AngularRate* rate : {&axis.measured, &axis.corrected, &axis.bias, &axis.sigma}) {
      *rate = core::rad_per_s(reader.take_float());
    }
  }
  return decoded;
}

/// The report in a frame.
[[nodiscard]] constexpr core::Result<Numbered<StatusReport>, FrameError> decode_status(
    std::span<const std::uint8_t> bytes) {
  const auto number = detail::open(bytes, FrameKind::status, kStatusFrameBytes);
  if (!number) return core::Unexpected{number.error()};
  ByteReader reader{bytes.subspan(detail::kHeaderBytes)};
  Numbered<StatusReport> decoded{.number = *number, .message = {}};
  app::LoopCounters& counters = decoded.message.counters;
  for (std::uint32_t* count :
       {&counters.samples, &counters.pulses, &counters.pulses_lost, &counters.odometer_errors,
        &counters.starts, &counters.start_errors, &counters.read_errors, &counters.overruns,
        &counters.configurations_lost, &decoded.message.frames_dropped}) {
    *count = reader.take<std::uint32_t>();
  }
  counters.last_error = {.code = static_cast<drivers::DriverErrorCode>(reader.take<std::uint8_t>()),
                         .bus = static_cast<hal::BusError>(reader.take<std::uint8_t>()),
                         .reg = reader.take<std::uint8_t>()};
  return decoded;
}

}  // namespace zerorate::wire
