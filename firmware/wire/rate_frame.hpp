/// @file
/// A rate message as bytes for datagrams and serial lines; see docs/reference/rate-frame.md.
#pragma once

#include <array>
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

inline constexpr std::size_t kLeastRateFrameBytes = 120;  ///< without vertical and accelerometer
inline constexpr std::size_t kMostRateFrameBytes = 196;

/// Bytes of a frame, as many as its message needs.
class RateFrame {
 public:
  /// @param size at most kMostRateFrameBytes
  constexpr explicit RateFrame(std::size_t size) : size_(size) {
    ZERORATE_ASSERT(size <= bytes_.size());
  }
  [[nodiscard]] constexpr std::span<const std::uint8_t> bytes() const {
    return std::span{bytes_}.first(size_);
  }
  [[nodiscard]] constexpr std::span<std::uint8_t> bytes() { return std::span{bytes_}.first(size_); }
  constexpr bool operator==(const RateFrame&) const = default;

 private:
  std::array<std::uint8_t, kMostRateFrameBytes> bytes_{};
  std::size_t size_;
};

/// Reasons why bytes are not a rate frame.
enum class FrameError : std::uint8_t {
  wrong_size,
  not_a_frame,       ///< it does not begin with "ZR"
  unknown_version,   ///< frame of a later program, or of none
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
inline constexpr std::uint8_t kRateVersion = 5;
inline constexpr std::size_t kChecksumBytes = 4;
/// Bits of byte 3: values that the message has.
inline constexpr unsigned kHasTemperature = 1U << 0U;
inline constexpr unsigned kHasPulses = 1U << 1U;
inline constexpr unsigned kHasUp = 1U << 2U;
inline constexpr unsigned kHasAcceleration = 1U << 3U;
inline constexpr unsigned kHasVibration = 1U << 4U;
inline constexpr unsigned kHasExplained = 1U << 5U;
inline constexpr unsigned kHasSlope = 1U << 6U;
/// Bits of version 4: the vertical axis.
inline constexpr unsigned kUpAxisShift = 3;
inline constexpr unsigned kPointsDown = 1U << 5U;

constexpr void put_rate(LittleEndianWriter& out, core::AngularRate rate) {
  out.put(rate.in(core::rad_per_s));
}
[[nodiscard]] constexpr core::AngularRate take_rate(LittleEndianReader& in) {
  return core::rad_per_s(in.take_float());
}
/// Vertical axis of version 4.
/// @return false where it is an axis that no sensor has
[[nodiscard]] constexpr bool take_up_axis(unsigned contents, std::optional<core::Direction>& up) {
  if ((contents & kHasUp) == 0) return true;
  const auto axis = static_cast<std::uint8_t>(contents >> kUpAxisShift & 3U);
  if (axis > 2) return false;
  up = core::UpAxis{.axis = axis, .points_down = (contents & kPointsDown) != 0}.direction();
  return true;
}
[[nodiscard]] constexpr unsigned contents_of(const app::RateMessage& message) {
  return (message.temperature ? kHasTemperature : 0U) |
         (message.odometer_pulses ? kHasPulses : 0U) | (message.up ? kHasUp : 0U) |
         (message.acceleration ? kHasAcceleration : 0U) | (message.vibration ? kHasVibration : 0U) |
         (message.explained ? kHasExplained : 0U) | (message.slope ? kHasSlope : 0U);
}
/// Bytes of a frame; 0: of an unknown version.
[[nodiscard]] constexpr std::size_t bytes_of(std::uint8_t version, unsigned contents) {
  constexpr std::array<std::uint8_t, 4> kOlder{72, 80, 112, 120};
  if (version == 0 || version > kRateVersion) return 0;
  if (version <= kOlder.size()) return kOlder[version - 1U];
  const auto has = [&](unsigned what) { return (contents & what) != 0; };
  return kLeastRateFrameBytes + (has(kHasUp) ? 20U : 0U) + (has(kHasAcceleration) ? 12U : 0U) +
         (has(kHasVibration) ? 4U : 0U) + (has(kHasExplained) ? 36U : 0U) +
         (has(kHasSlope) ? 4U : 0U);
}
static_assert(bytes_of(kRateVersion, 0xFF) == kMostRateFrameBytes);
constexpr void put_angle(LittleEndianWriter& out, core::Angle angle) {
  out.put(angle.in(core::rad));
}
[[nodiscard]] constexpr core::Angle take_angle(LittleEndianReader& in) {
  return core::rad(in.take_float());
}
constexpr void put_inputs(LittleEndianWriter& out, const app::RateMessage& message) {
  out.put(message.temperature ? message.temperature->degc() : 0.0F);
  out.put(message.odometer_pulses.value_or(0));
}
constexpr void take_inputs(LittleEndianReader& in, unsigned contents, app::RateMessage& message) {
  const float degc = in.take_float();
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
/// The blocks at the end, each where the message has its values.
constexpr void put_blocks(LittleEndianWriter& out, const app::RateMessage& message) {
  if (message.up) {
    for (const float share : *message.up) out.put(share);
    put_angle(out, message.vertical_turn.angle);
    put_angle(out, message.vertical_turn.sigma);
  }
  if (message.acceleration) {
    for (const auto force : *message.acceleration) out.put(force.in(core::m_per_s2));
  }
  if (message.vibration) out.put(message.vibration->in(core::m_per_s2));
  if (message.explained) {
    for (const app::ExplainedBias& axis : *message.explained) {
      for (const auto rate : {axis.temperature, axis.acceleration, axis.vibration}) {
        put_rate(out, rate);
      }
    }
  }
  if (message.slope) put_angle(out, *message.slope);
}
constexpr void take_blocks(LittleEndianReader& in, unsigned contents, app::RateMessage& message) {
  if ((contents & kHasUp) != 0) {
    for (float& share : message.up.emplace()) share = in.take_float();
    message.vertical_turn.angle = take_angle(in);
    message.vertical_turn.sigma = take_angle(in);
  }
  if ((contents & kHasAcceleration) != 0) {
    for (auto& force : message.acceleration.emplace()) force = core::m_per_s2(in.take_float());
  }
  if ((contents & kHasVibration) != 0) message.vibration = core::m_per_s2(in.take_float());
  if ((contents & kHasExplained) != 0) {
    for (app::ExplainedBias& axis : message.explained.emplace()) {
      for (auto* const rate : {&axis.temperature, &axis.acceleration, &axis.vibration}) {
        *rate = take_rate(in);
      }
    }
  }
  if ((contents & kHasSlope) != 0) message.slope = take_angle(in);
}
}  // namespace detail

/// Cost: 196 bytes of stack and the checksum of the bytes in use; no heap.
[[nodiscard]] constexpr RateFrame encode_rate_frame(std::uint32_t sequence,
                                                    const app::RateMessage& message) {
  const unsigned contents = detail::contents_of(message);
  RateFrame frame{detail::bytes_of(detail::kRateVersion, contents)};
  LittleEndianWriter out{frame.bytes()};
  out.put(detail::kMagic);
  out.put(detail::kRateVersion);
  out.put(static_cast<std::uint8_t>(contents));
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
  detail::put_blocks(out, message);
  out.put(core::crc32(frame.bytes().first(frame.bytes().size() - detail::kChecksumBytes)));
  return frame;
}
[[nodiscard]] constexpr RateFrame encode_rate_frame(const NumberedMessage& numbered) {
  return encode_rate_frame(numbered.sequence, numbered.message);
}

/// The inverse, for bytes of any origin. A frame of version 1 has neither temperature nor pulses,
/// one of version 2 no turn, one of version 3 no heading. One of version 4 has the vertical as an
/// axis, and nothing of an accelerometer.
[[nodiscard]] constexpr core::Result<NumberedMessage, FrameError> decode_rate_frame(
    std::span<const std::uint8_t> bytes) {
  using core::Unexpected;
  if (bytes.size() < detail::bytes_of(1, 0)) return Unexpected{FrameError::wrong_size};
  LittleEndianReader in{bytes};
  if (in.take<std::uint16_t>() != detail::kMagic) return Unexpected{FrameError::not_a_frame};
  const auto version = in.take<std::uint8_t>();
  const unsigned contents = in.take<std::uint8_t>();
  const std::size_t size = detail::bytes_of(version, contents);
  if (size == 0) return Unexpected{FrameError::unknown_version};
  if (size != bytes.size()) return Unexpected{FrameError::wrong_size};
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
  }
  if (version == 4 && !detail::take_up_axis(contents, message.up)) {
    return Unexpected{FrameError::impossible_value};
  }
  if (version > 4) detail::take_blocks(in, contents, message);
  return numbered;
}

}  // namespace zerorate::wire
