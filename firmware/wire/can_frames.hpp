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
#include "firmware/wire/can_bits.hpp"
#include "firmware/wire/explained_shares.hpp"
#include "firmware/wire/health_bits.hpp"
#include "firmware/wire/rate_frame.hpp"

namespace zerorate::wire {

/// Classic frame of eight bytes with an 11-bit identifier.
struct CanFrame {
  std::uint16_t id = 0;
  std::array<std::uint8_t, 8> data{};

  constexpr bool operator==(const CanFrame&) const = default;
};

/// Number of frames of one message: x, y, z, then the status that makes the three valid.
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
/// Greatest identifier of the status frame: that of the last frame must still have 11 bits.
inline constexpr std::uint16_t kGreatestCanId = 0x7FF - kCanVerticalTurnOffset;
/// Messages from one frame of the inputs and of the explained bias to the next: they change slowly,
/// and the bus is shared.
inline constexpr std::uint32_t kCanInputsEvery = 16;
/// Messages from the frames of the turn, the vertical, the direction up and the acceleration to the
/// next: an angle is a sum, and misses nothing.
inline constexpr std::uint32_t kCanTurnEvery = 4;

inline constexpr float kCanRateLsbDegPerS = 1e-6F;
inline constexpr float kCanSigmaLsbDegPerS = 1e-5F;
inline constexpr float kCanTurnLsbDeg = 1e-3F;
inline constexpr float kCanTurnSigmaLsbDeg = 1e-3F;
inline constexpr float kCanVerticalRateLsbDegPerS = 1e-5F;
inline constexpr float kCanHeadingLsbDeg = 0.01F;
inline constexpr float kCanUpLsb = 1e-4F;
inline constexpr float kCanAccelerationLsbMPerS2 = 0.01F;
inline constexpr float kCanVibrationLsbMPerS2 = 1e-3F;
inline constexpr float kCanExplainedLsbDegPerS = 1e-4F;
inline constexpr float kCanTemperatureLsbDegC = 0.01F;

namespace detail {
inline constexpr std::size_t kCounterBits = 4;
/// Identifiers are those of the status frame plus an offset.
[[nodiscard]] constexpr CanFrame frame_at(std::uint16_t id, std::size_t offset) {
  ZERORATE_ASSERT(id <= kGreatestCanId);
  return {.id = static_cast<std::uint16_t>(id + offset)};
}
[[nodiscard]] constexpr std::uint32_t encode_can_sigma(core::AngularRate sigma) {
  return encode_can_unsigned(sigma.in(core::deg_per_s) / kCanSigmaLsbDegPerS, 16);
}
[[nodiscard]] constexpr std::uint32_t encode_can_turn_sigma(core::Angle sigma) {
  return encode_can_unsigned(sigma.in(core::deg) / kCanTurnSigmaLsbDeg, 16);
}
[[nodiscard]] constexpr std::uint32_t encode_can_temperature(
    const std::optional<core::Temperature>& temperature) {
  if (!temperature) return can_not_available_signed(16);
  return encode_can_signed(temperature->degc() / kCanTemperatureLsbDegC, 16);
}
/// Heading from -180 to 180 deg; not available where its deviation is infinite.
[[nodiscard]] constexpr std::uint32_t encode_can_heading(const app::Heading& heading) {
  if (!core::is_finite(heading.sigma.in(core::deg))) return can_not_available_signed(16);
  return encode_can_signed(heading.angle.in(core::deg) / kCanHeadingLsbDeg, 16);
}
[[nodiscard]] constexpr CanFrame encode_can_turn_of(const app::AxisTurn& turn, core::Duration time,
                                                    CanFrame frame, std::uint32_t counter) {
  constexpr std::int64_t kLongest_s = 0xFFFF;
  const std::int64_t time_s = time / core::Duration::seconds(1);
  CanBitWriter out{frame.data};
  out.put(encode_can_signed(turn.angle.in(core::deg) / kCanTurnLsbDeg, 28), 28);
  out.put(encode_can_turn_sigma(turn.sigma), 16);
  out.put(static_cast<std::uint32_t>(time_s < kLongest_s ? time_s : kLongest_s), 16);
  out.put(counter, kCounterBits);
  return frame;
}
}  // namespace detail

/// @param numbered  its number counts the messages on this bus: each frame has it modulo 16
/// @param id        identifier of the status frame, at most kGreatestCanId
[[nodiscard]] constexpr std::array<CanFrame, kCanFrames> encode_can_frames(
    const NumberedMessage& numbered, std::uint16_t id) {
  std::array<CanFrame, kCanFrames> frames{};
  const app::RateMessage& message = numbered.message;
  for (std::size_t i = 0; i < message.axes.size(); ++i) {
    const auto count_of = [](core::AngularRate rate) {
      return rate.in(core::deg_per_s) / kCanRateLsbDegPerS;
    };
    frames[i] = detail::frame_at(id, 1 + i);
    CanBitWriter out{frames[i].data};
    out.put(message.has_rate() ? encode_can_signed(count_of(message.axes[i].corrected), 32)
                               : can_not_available_signed(32),
            32);
    out.put(encode_can_signed(count_of(message.axes[i].bias), 28), 28);
    out.put(numbered.sequence, detail::kCounterBits);
  }
  frames[3] = detail::frame_at(id, 0);
  CanBitWriter out{frames[3].data};
  // The ninth and tenth bit of the health stand before the others. The later bits, which are no
  // alarms of a single sample, are in the frame of the inputs.
  const std::uint32_t health = encode_health(message.health);
  out.put(static_cast<std::uint32_t>(message.motion), 2);
  out.put(numbered.sequence, detail::kCounterBits);
  out.put(health >> 8U, 2);
  out.put(health, 8);
  for (const app::AxisRate& axis : message.axes) out.put(detail::encode_can_sigma(axis.sigma), 16);
  return frames;
}

/// Frame of temperature, odometer and calm. Send it with every kCanInputsEvery-th message.
/// @param id  identifier of the status frame, at most kGreatestCanId
[[nodiscard]] constexpr CanFrame encode_can_inputs(const NumberedMessage& numbered,
                                                   std::uint16_t id) {
  const app::RateMessage& message = numbered.message;
  CanFrame frame = detail::frame_at(id, kCanInputsOffset);
  CanBitWriter out{frame.data};
  out.put(detail::encode_can_temperature(message.temperature), 16);
  out.put(message.odometer_pulses.value_or(0), 32);
  out.put(message.odometer_pulses ? 1U : 0U, 1);
  for (const bool flag :
       {message.health.odometer_dead_band, message.health.sample_rate_off,
        message.health.reference_disagreement, message.health.acceleration_missing}) {
    out.put(flag ? 1U : 0U, 1);
  }
  out.put(message.calm_percent <= 100 ? message.calm_percent : can_not_available_unsigned(7), 7);
  out.put(numbered.sequence / kCanInputsEvery, detail::kCounterBits);
  return frame;
}

/// Frames of the turn of x, y and z since departure. Send them with every kCanTurnEvery-th message.
/// @param id  identifier of the status frame, at most kGreatestCanId
[[nodiscard]] constexpr std::array<CanFrame, kCanTurnFrames> encode_can_turn(
    const NumberedMessage& numbered, std::uint16_t id) {
  std::array<CanFrame, kCanTurnFrames> frames{};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i] = detail::encode_can_turn_of(numbered.message.turn[i], numbered.message.turn_time,
                                           detail::frame_at(id, kCanTurnOffset + i),
                                           numbered.sequence / kCanTurnEvery);
  }
  return frames;
}
/// Frame of the turn about the vertical since departure, of a message with `up`. Send it with every
/// kCanTurnEvery-th message.
/// @param id  identifier of the status frame, at most kGreatestCanId
[[nodiscard]] constexpr CanFrame encode_can_vertical_turn(const NumberedMessage& numbered,
                                                          std::uint16_t id) {
  return detail::encode_can_turn_of(numbered.message.vertical_turn, numbered.message.turn_time,
                                    detail::frame_at(id, kCanVerticalTurnOffset),
                                    numbered.sequence / kCanTurnEvery);
}

/// Frame of rate and heading about the vertical, of a message with `up`. Send it with every
/// kCanTurnEvery-th message.
/// @param id  identifier of the status frame, at most kGreatestCanId
[[nodiscard]] constexpr CanFrame encode_can_vertical(const NumberedMessage& numbered,
                                                     std::uint16_t id) {
  const app::RateMessage& message = numbered.message;
  CanFrame frame = detail::frame_at(id, kCanVerticalOffset);
  CanBitWriter out{frame.data};
  out.put(message.has_rate()
              ? encode_can_signed(
                    message.vertical_rate().in(core::deg_per_s) / kCanVerticalRateLsbDegPerS, 28)
              : can_not_available_signed(28),
          28);
  out.put(detail::encode_can_heading(message.heading), 16);
  out.put(detail::encode_can_turn_sigma(message.heading.sigma), 16);
  out.put(numbered.sequence / kCanTurnEvery, detail::kCounterBits);
  return frame;
}

/// Frame of the direction that points up, of a message with `up`. Send it with every
/// kCanTurnEvery-th message.
/// @param id  identifier of the status frame, at most kGreatestCanId
[[nodiscard]] constexpr CanFrame encode_can_up(const NumberedMessage& numbered, std::uint16_t id) {
  CanFrame frame = detail::frame_at(id, kCanUpOffset);
  CanBitWriter out{frame.data};
  for (const float share : *numbered.message.up) {
    out.put(encode_can_signed(share / kCanUpLsb, 16), 16);
  }
  out.put(0, 12);
  out.put(numbered.sequence / kCanTurnEvery, detail::kCounterBits);
  return frame;
}

/// Frame of acceleration and vibration, of a message with either. Send it with every
/// kCanTurnEvery-th message.
/// @param id  identifier of the status frame, at most kGreatestCanId
[[nodiscard]] constexpr CanFrame encode_can_acceleration(const NumberedMessage& numbered,
                                                         std::uint16_t id) {
  const app::RateMessage& message = numbered.message;
  CanFrame frame = detail::frame_at(id, kCanAccelerationOffset);
  CanBitWriter out{frame.data};
  for (std::size_t i = 0; i < 3; ++i) {
    out.put(message.acceleration
                ? encode_can_signed(
                      (*message.acceleration)[i].in(core::m_per_s2) / kCanAccelerationLsbMPerS2, 15)
                : can_not_available_signed(15),
            15);
  }
  out.put(
      message.vibration
          ? encode_can_unsigned(message.vibration->in(core::m_per_s2) / kCanVibrationLsbMPerS2, 15)
          : can_not_available_unsigned(15),
      15);
  out.put(numbered.sequence / kCanTurnEvery, detail::kCounterBits);
  return frame;
}

/// Frames of what the inputs explain of the bias of x, y and z, of a message with `explained`. Send
/// them with every kCanInputsEvery-th message.
/// @param id  identifier of the status frame, at most kGreatestCanId
[[nodiscard]] constexpr std::array<CanFrame, kCanExplainedFrames> encode_can_explained(
    const NumberedMessage& numbered, std::uint16_t id) {
  std::array<CanFrame, kCanExplainedFrames> frames{};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i] = detail::frame_at(id, kCanExplainedOffset + i);
    CanBitWriter out{frames[i].data};
    for (const ExplainedShare& share : kExplainedShares) {
      const float dps = ((*numbered.message.explained)[i].*share.rate).in(core::deg_per_s);
      out.put(encode_can_signed(dps / kCanExplainedLsbDegPerS, 16), 16);
    }
    out.put(0, 12);
    out.put(numbered.sequence / kCanInputsEvery, detail::kCounterBits);
  }
  return frames;
}

}  // namespace zerorate::wire
