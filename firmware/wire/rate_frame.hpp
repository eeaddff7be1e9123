/// @file
/// A rate message as bytes for datagrams and serial lines; see docs/reference/rate-frame.md.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/crc32.hpp"
#include "core/base/result.hpp"
#include "firmware/app/rate_message.hpp"
#include "firmware/wire/health_bits.hpp"
#include "firmware/wire/little_endian.hpp"

namespace zerorate::wire {

inline constexpr std::size_t kRateFrameBytes = 120;
inline constexpr std::size_t kRateFrameBytesOfVersion3 = 112;
inline constexpr std::size_t kRateFrameBytesOfVersion2 = 80;
inline constexpr std::size_t kRateFrameBytesOfVersion1 = 72;
using RateFrame = std::array<std::uint8_t, kRateFrameBytes>;

/// Reasons why bytes are not a rate frame.
enum class FrameError : std::uint8_t {
  wrong_size,
  not_a_frame,       ///< it does not begin with "ZR"
  unknown_version,   ///< frame of a later program
  wrong_checksum,    ///< damaged on the way
  impossible_value,  ///< checksum right, motion unknown: made by something else
};

/// A message and its number; numbers of a sender follow each other, so that a gap is a loss.
struct NumberedMessage {
  std::uint32_t sequence = 0;
  app::RateMessage message;

  constexpr bool operator==(const NumberedMessage&) const = default;
};

namespace detail {
inline constexpr std::uint16_t kMagic = 0x525A;  // "ZR"
inline constexpr std::uint8_t kVersion = 1;      // version of the other frames
inline constexpr std::uint8_t kRateVersion = 4;
inline constexpr std::size_t kChecksumBytes = 4;
/// Bits of byte 3: values that the message has, and its vertical axis.
inline constexpr unsigned kHasTemperature = 1U << 0U;
inline constexpr unsigned kHasPulses = 1U << 1U;
inline constexpr unsigned kHasUp = 1U << 2U;
inline constexpr unsigned kUpShift = 3;
inline constexpr unsigned kPointsDown = 1U << 5U;

constexpr void put_rate(LittleEndianWriter& out, core::AngularRate rate) {
  out.put(std::bit_cast<std::uint32_t>(rate.in(core::rad_per_s)));
}
[[nodiscard]] constexpr core::AngularRate take_rate(LittleEndianReader& in) {
  return core::rad_per_s(std::bit_cast<float>(in.take<std::uint32_t>()));
}
[[nodiscard]] constexpr unsigned up_of(const std::optional<core::UpAxis>& up) {
  if (!up) return 0;
  return kHasUp | unsigned{up->axis} << kUpShift | (up->points_down ? kPointsDown : 0U);
}
/// @return false where it is an axis that no sensor has
[[nodiscard]] constexpr bool take_up(unsigned contents, std::optional<core::UpAxis>& up) {
  if ((contents & kHasUp) == 0) return true;
  const auto axis = static_cast<std::uint8_t>(contents >> kUpShift & 3U);
  up = core::UpAxis{.axis = axis, .points_down = (contents & kPointsDown) != 0};
  return axis < 3;
}
[[nodiscard]] constexpr std::uint8_t contents_of(const app::RateMessage& message) {
  return static_cast<std::uint8_t>((message.temperature ? kHasTemperature : 0U) |
                                   (message.odometer_pulses ? kHasPulses : 0U) | up_of(message.up));
}
constexpr void put_angle(LittleEndianWriter& out, core::Angle angle) {
  out.put(std::bit_cast<std::uint32_t>(angle.in(core::rad)));
}
[[nodiscard]] constexpr core::Angle take_angle(LittleEndianReader& in) {
  return core::rad(std::bit_cast<float>(in.take<std::uint32_t>()));
}
constexpr void put_inputs(LittleEndianWriter& out, const app::RateMessage& message) {
  const float degc = message.temperature ? message.temperature->degc() : 0.0F;
  out.put(std::bit_cast<std::uint32_t>(degc));
  out.put(message.odometer_pulses.value_or(0));
}
constexpr void take_inputs(LittleEndianReader& in, unsigned contents, app::RateMessage& message) {
  const float degc = std::bit_cast<float>(in.take<std::uint32_t>());
  const auto pulses = in.take<std::uint32_t>();
  if ((contents & kHasTemperature) != 0) {
    message.temperature = core::Temperature::from_degc(degc);
  }
  if ((contents & kHasPulses) != 0) message.odometer_pulses = pulses;
}
constexpr void put_turn(LittleEndianWriter& out, const app::RateMessage& message) {
  for (const app::AxisTurn& turn : message.turn) {
    put_angle(out, turn.angle);
    put_angle(out, turn.sigma);
  }
  out.put(static_cast<std::uint64_t>(message.turn_time.ns()));
}
constexpr void take_turn(LittleEndianReader& in, app::RateMessage& message) {
  for (app::AxisTurn& turn : message.turn) {
    turn.angle = take_angle(in);
    turn.sigma = take_angle(in);
  }
  message.turn_time =
      core::Duration::nanoseconds(static_cast<std::int64_t>(in.take<std::uint64_t>()));
}
/// Version of a frame of this length; 0: of none.
[[nodiscard]] constexpr std::uint8_t version_of_length(std::size_t bytes) {
  if (bytes == kRateFrameBytes) return kRateVersion;
  if (bytes == kRateFrameBytesOfVersion3) return 3;
  if (bytes == kRateFrameBytesOfVersion2) return 2;
  return bytes == kRateFrameBytesOfVersion1 ? 1 : 0;
}
}  // namespace detail

/// Cost: 120 bytes of stack and their checksum; no heap.
[[nodiscard]] constexpr RateFrame encode_rate_frame(std::uint32_t sequence,
                                                    const app::RateMessage& message) {
  RateFrame frame{};
  LittleEndianWriter out{frame};
  out.put(detail::kMagic);
  out.put(detail::kRateVersion);
  out.put(detail::contents_of(message));
  out.put(sequence);
  out.put(static_cast<std::uint64_t>(message.time.ns()));
  out.put(static_cast<std::uint8_t>(message.motion));
  out.put(encode_health(message.health));
  out.put(message.calm_percent);
  for (const app::AxisRate& axis : message.axes) {
    for (const auto rate : {axis.measured, axis.corrected, axis.bias, axis.sigma}) {
      detail::put_rate(out, rate);
    }
  }
  detail::put_inputs(out, message);
  detail::put_turn(out, message);
  detail::put_angle(out, message.heading.angle);
  detail::put_angle(out, message.heading.sigma);
  out.put(core::crc32(std::span{frame}.first<kRateFrameBytes - detail::kChecksumBytes>()));
  return frame;
}
[[nodiscard]] constexpr RateFrame encode_rate_frame(const NumberedMessage& numbered) {
  return encode_rate_frame(numbered.sequence, numbered.message);
}

/// The inverse, for bytes of any origin. A frame of version 1 has neither temperature nor pulses,
/// one of version 2 no turn, one of version 3 no heading.
[[nodiscard]] constexpr core::Result<NumberedMessage, FrameError> decode_rate_frame(
    std::span<const std::uint8_t> bytes) {
  using core::Unexpected;
  const std::uint8_t version = detail::version_of_length(bytes.size());
  if (version == 0) return Unexpected{FrameError::wrong_size};
  LittleEndianReader in{bytes};
  if (in.take<std::uint16_t>() != detail::kMagic) return Unexpected{FrameError::not_a_frame};
  if (in.take<std::uint8_t>() != version) return Unexpected{FrameError::unknown_version};
  const unsigned contents = in.take<std::uint8_t>();
  const std::size_t checked = bytes.size() - detail::kChecksumBytes;
  LittleEndianReader checksum{bytes.subspan(checked)};
  if (checksum.take<std::uint32_t>() != core::crc32(bytes.first(checked))) {
    return Unexpected{FrameError::wrong_checksum};
  }
  NumberedMessage numbered{.sequence = in.take<std::uint32_t>(), .message = {}};
  app::RateMessage& message = numbered.message;
  message.time = core::Instant::from_ns(static_cast<std::int64_t>(in.take<std::uint64_t>()));
  const auto motion = in.take<std::uint8_t>();
  if (motion > static_cast<std::uint8_t>(core::Motion::still)) {
    return Unexpected{FrameError::impossible_value};
  }
  message.motion = static_cast<core::Motion>(motion);
  message.health = decode_health(in.take<std::uint16_t>());
  message.calm_percent = in.take<std::uint8_t>();
  for (app::AxisRate& axis : message.axes) {
    for (auto* const rate : {&axis.measured, &axis.corrected, &axis.bias, &axis.sigma}) {
      *rate = detail::take_rate(in);
    }
  }
  if (version > 1) detail::take_inputs(in, contents, message);
  if (version > 2) detail::take_turn(in, message);
  if (version > 3) {
    message.heading.angle = detail::take_angle(in);
    message.heading.sigma = detail::take_angle(in);
    if (!detail::take_up(contents, message.up)) return Unexpected{FrameError::impossible_value};
  }
  return numbered;
}

}  // namespace zerorate::wire
