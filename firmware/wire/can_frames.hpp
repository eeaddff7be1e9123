/// @file
/// A rate message as classic CAN frames; firmware/wire/zerorate.dbc describes them to other tools.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/numeric.hpp"
#include "core/base/units.hpp"
#include "firmware/app/rate_message.hpp"
#include "firmware/wire/explained_shares.hpp"
#include "firmware/wire/health_bits.hpp"
#include "firmware/wire/little_endian.hpp"
#include "firmware/wire/rate_frame.hpp"

namespace zerorate::wire {

/// Eight bytes with an 11-bit identifier.
struct CanFrame {
  std::uint16_t id = 0;
  std::array<std::uint8_t, 8> data{};

  constexpr bool operator==(const CanFrame&) const = default;
};

/// The frames of one message: x, y, z, then the status that makes the three valid.
inline constexpr std::size_t kCanFrames = 4;
/// Identifier of the status frame unless set otherwise; the axes follow it.
inline constexpr std::uint16_t kDefaultCanId = 0x200;
/// Identifier of the frame of the inputs, from that of the status frame.
inline constexpr std::uint16_t kCanInputsOffset = 4;
/// Identifier of the turn of axis x, from that of the status frame; y and z follow.
inline constexpr std::uint16_t kCanTurnOffset = 5;
inline constexpr std::size_t kCanTurnFrames = 3;
/// Identifier of the vertical's frame, from that of the status frame.
inline constexpr std::uint16_t kCanVerticalOffset = 8;
/// Identifiers of the frames of the direction that points up and of the acceleration, and of the
/// explained bias of axis x, from that of the status frame; y and z follow.
inline constexpr std::uint16_t kCanUpOffset = 9;
inline constexpr std::uint16_t kCanAccelerationOffset = 10;
inline constexpr std::uint16_t kCanExplainedOffset = 11;
inline constexpr std::size_t kCanExplainedFrames = 3;
/// Identifier of the frame of the turn about the vertical, from that of the status frame.
inline constexpr std::uint16_t kCanVerticalTurnOffset = 14;
/// Greatest identifier of the status frame: the last frame must still have 11 bits.
inline constexpr std::uint16_t kGreatestCanId = 0x7FF - kCanVerticalTurnOffset;
/// Messages from one frame of the inputs and of the explained bias to the next: they change slowly,
/// and the bus is shared.
inline constexpr std::uint32_t kCanInputsEvery = 16;
/// Messages from the frames of the turn, the vertical, the direction up and the acceleration to the
/// next: an angle is a sum, and misses nothing.
inline constexpr std::uint32_t kCanTurnEvery = 4;

inline constexpr float kCanRateLsbDegPerS = 1e-6F;
inline constexpr float kCanSigmaLsbDegPerS = 1e-5F;
inline constexpr float kCanTurnLsbDeg = 1e-4F;
inline constexpr float kCanTurnSigmaLsbDeg = 1e-3F;
inline constexpr float kCanHeadingLsbDeg = 0.01F;
inline constexpr float kCanUpLsb = 1e-4F;
inline constexpr float kCanAccelerationLsbMPerS2 = 0.01F;
inline constexpr float kCanVibrationLsbMPerS2 = 1e-3F;
inline constexpr float kCanExplainedLsbDegPerS = 1e-4F;
/// Content of a signal for which there is no value, or none that fits.
inline constexpr std::uint32_t kCanRateNotAvailable = 0x80000000U;
inline constexpr std::uint16_t kCanSigmaNotAvailable = 0xFFFFU;
inline constexpr float kCanTemperatureLsbDegC = 0.01F;
/// Content of a signal of 16 bits with a sign for which there is no value.
inline constexpr std::uint16_t kCanShortNotAvailable = 0x8000U;

namespace detail {
/// Signal of 16 or 32 bits: the nearest count of its LSB, ties away from zero.
/// @param not_available content where the count does not lie inside (-limit, limit)
template <class Content>
[[nodiscard]] constexpr Content encode_count(float count, float limit, Content not_available) {
  if (!(count > -limit && count < limit)) return not_available;
  return static_cast<Content>(
      static_cast<std::int32_t>(count < 0.0F ? count - 0.5F : count + 0.5F));
}
/// A rate or an angle.
[[nodiscard]] constexpr std::uint32_t encode_can_value(float count) {
  return encode_count(count, 2147483000.0F, kCanRateNotAvailable);
}
[[nodiscard]] constexpr std::uint16_t encode_can_sigma(float count) {
  return encode_count(count, 65534.0F, kCanSigmaNotAvailable);
}
[[nodiscard]] constexpr std::uint16_t encode_can_short(float count) {
  return encode_count(count, 32767.0F, kCanShortNotAvailable);
}
[[nodiscard]] constexpr std::uint32_t encode_can_rate(core::AngularRate rate) {
  return encode_can_value(rate.in(core::deg_per_s) / kCanRateLsbDegPerS);
}
[[nodiscard]] constexpr std::uint16_t encode_can_temperature(
    const std::optional<core::Temperature>& temperature) {
  if (!temperature) return kCanShortNotAvailable;
  return encode_can_short(temperature->degc() / kCanTemperatureLsbDegC);
}
/// Heading from -180 to 180 deg; not available where its deviation is infinite.
[[nodiscard]] constexpr std::uint16_t encode_can_heading(const app::Heading& heading) {
  const bool is_known = core::is_finite(heading.sigma.in(core::deg));
  if (!is_known) return kCanShortNotAvailable;
  return encode_can_short(heading.angle.in(core::deg) / kCanHeadingLsbDeg);
}
[[nodiscard]] constexpr CanFrame encode_can_turn_of(const app::AxisTurn& turn, core::Duration time,
                                                    std::uint16_t id) {
  constexpr std::int64_t kLongest_s = 0xFFFF;
  const std::int64_t time_s = time / core::Duration::seconds(1);
  CanFrame frame{.id = id};
  LittleEndianWriter out{frame.data};
  out.put(encode_can_value(turn.angle.in(core::deg) / kCanTurnLsbDeg));
  out.put(encode_can_sigma(turn.sigma.in(core::deg) / kCanTurnSigmaLsbDeg));
  out.put(static_cast<std::uint16_t>(time_s < kLongest_s ? time_s : kLongest_s));
  return frame;
}
}  // namespace detail

/// @param id  identifier of the status frame, at most kGreatestCanId
[[nodiscard]] constexpr std::array<CanFrame, kCanFrames> encode_can_frames(
    const NumberedMessage& numbered, std::uint16_t id) {
  ZERORATE_ASSERT(id <= kGreatestCanId);
  std::array<CanFrame, kCanFrames> frames{};
  const app::RateMessage& message = numbered.message;
  for (std::size_t i = 0; i < message.axes.size(); ++i) {
    frames[i].id = static_cast<std::uint16_t>(id + 1 + i);
    LittleEndianWriter out{frames[i].data};
    out.put(message.has_rate() ? detail::encode_can_rate(message.axes[i].corrected)
                               : kCanRateNotAvailable);
    out.put(detail::encode_can_rate(message.axes[i].bias));
  }
  frames[3].id = id;
  LittleEndianWriter out{frames[3].data};
  // The counter counts modulo 16; of the health the ninth and tenth bit stand above it. The later
  // bits, which are no alarms of a single sample, are in the frame of the inputs.
  const unsigned health = encode_health(message.health) & 0x3FFU;
  out.put(static_cast<std::uint8_t>(static_cast<unsigned>(message.motion) |
                                    (numbered.sequence & 0xFU) << 2U | (health >> 8U) << 6U));
  out.put(static_cast<std::uint8_t>(health & 0xFFU));
  for (const app::AxisRate& axis : message.axes) {
    out.put(detail::encode_can_sigma(axis.sigma.in(core::deg_per_s) / kCanSigmaLsbDegPerS));
  }
  return frames;
}

/// Frame of temperature, odometer and calm. Send it with every kCanInputsEvery-th message.
/// @param id  identifier of the status frame, at most kGreatestCanId
[[nodiscard]] constexpr CanFrame encode_can_inputs(const app::RateMessage& message,
                                                   std::uint16_t id) {
  ZERORATE_ASSERT(id <= kGreatestCanId);
  CanFrame frame{.id = static_cast<std::uint16_t>(id + kCanInputsOffset)};
  LittleEndianWriter out{frame.data};
  out.put(detail::encode_can_temperature(message.temperature));
  out.put(message.odometer_pulses.value_or(0));
  out.put(static_cast<std::uint8_t>((message.odometer_pulses ? 1U : 0U) |
                                    (message.health.odometer_dead_band ? 2U : 0U) |
                                    (message.health.sample_rate_off ? 4U : 0U) |
                                    (message.health.reference_disagreement ? 8U : 0U) |
                                    (message.health.acceleration_missing ? 16U : 0U)));
  out.put(message.calm_percent);
  return frame;
}

/// Frames of the turn of x, y and z since departure. Send them with every kCanTurnEvery-th message.
/// @param id  identifier of the status frame, at most kGreatestCanId
[[nodiscard]] constexpr std::array<CanFrame, kCanTurnFrames> encode_can_turn(
    const app::RateMessage& message, std::uint16_t id) {
  ZERORATE_ASSERT(id <= kGreatestCanId);
  std::array<CanFrame, kCanTurnFrames> frames{};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i] = detail::encode_can_turn_of(message.turn[i], message.turn_time,
                                           static_cast<std::uint16_t>(id + kCanTurnOffset + i));
  }
  return frames;
}
/// Frame of the turn about the vertical since departure, of a message with `up`. Send it with every
/// kCanTurnEvery-th message.
/// @param id  identifier of the status frame, at most kGreatestCanId
[[nodiscard]] constexpr CanFrame encode_can_vertical_turn(const app::RateMessage& message,
                                                          std::uint16_t id) {
  ZERORATE_ASSERT(id <= kGreatestCanId);
  return detail::encode_can_turn_of(message.vertical_turn, message.turn_time,
                                    static_cast<std::uint16_t>(id + kCanVerticalTurnOffset));
}

/// Frame of rate and heading about the vertical, of a message with `up`. Send it with every
/// kCanTurnEvery-th message.
/// @param id  identifier of the status frame, at most kGreatestCanId
[[nodiscard]] constexpr CanFrame encode_can_vertical(const app::RateMessage& message,
                                                     std::uint16_t id) {
  ZERORATE_ASSERT(id <= kGreatestCanId);
  CanFrame frame{.id = static_cast<std::uint16_t>(id + kCanVerticalOffset)};
  LittleEndianWriter out{frame.data};
  out.put(message.has_rate() ? detail::encode_can_rate(message.vertical_rate())
                             : kCanRateNotAvailable);
  out.put(detail::encode_can_heading(message.heading));
  out.put(detail::encode_can_sigma(message.heading.sigma.in(core::deg) / kCanTurnSigmaLsbDeg));
  return frame;
}

/// Frame of the direction that points up, of a message with `up`. Send it with every
/// kCanTurnEvery-th message.
/// @param id  identifier of the status frame, at most kGreatestCanId
[[nodiscard]] constexpr CanFrame encode_can_up(const app::RateMessage& message, std::uint16_t id) {
  ZERORATE_ASSERT(id <= kGreatestCanId);
  CanFrame frame{.id = static_cast<std::uint16_t>(id + kCanUpOffset)};
  LittleEndianWriter out{frame.data};
  for (const float share : *message.up) out.put(detail::encode_can_short(share / kCanUpLsb));
  return frame;
}

/// Frame of acceleration and vibration, of a message with either. Send it with every
/// kCanTurnEvery-th message.
/// @param id  identifier of the status frame, at most kGreatestCanId
[[nodiscard]] constexpr CanFrame encode_can_acceleration(const app::RateMessage& message,
                                                         std::uint16_t id) {
  ZERORATE_ASSERT(id <= kGreatestCanId);
  CanFrame frame{.id = static_cast<std::uint16_t>(id + kCanAccelerationOffset)};
  LittleEndianWriter out{frame.data};
  for (std::size_t i = 0; i < 3; ++i) {
    out.put(message.acceleration
                ? detail::encode_can_short((*message.acceleration)[i].in(core::m_per_s2) /
                                           kCanAccelerationLsbMPerS2)
                : kCanShortNotAvailable);
  }
  out.put(message.vibration ? detail::encode_can_sigma(message.vibration->in(core::m_per_s2) /
                                                       kCanVibrationLsbMPerS2)
                            : kCanSigmaNotAvailable);
  return frame;
}

/// Frames of what the inputs explain of the bias of x, y and z, of a message with `explained`. Send
/// them with every kCanInputsEvery-th message.
/// @param id  identifier of the status frame, at most kGreatestCanId
[[nodiscard]] constexpr std::array<CanFrame, kCanExplainedFrames> encode_can_explained(
    const app::RateMessage& message, std::uint16_t id) {
  ZERORATE_ASSERT(id <= kGreatestCanId);
  std::array<CanFrame, kCanExplainedFrames> frames{};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].id = static_cast<std::uint16_t>(id + kCanExplainedOffset + i);
    LittleEndianWriter out{frames[i].data};
    for (const ExplainedShare& share : kExplainedShares) {
      const float dps = ((*message.explained)[i].*share.rate).in(core::deg_per_s);
      out.put(detail::encode_can_short(dps / kCanExplainedLsbDegPerS));
    }
  }
  return frames;
}

}  // namespace zerorate::wire
