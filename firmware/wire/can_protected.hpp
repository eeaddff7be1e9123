/// @file
/// One sample in one frame for a vehicle's controller, protected end to end: eight bytes of the yaw
/// rate, or 24 bytes of CAN FD with all three axes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/base/units.hpp"
#include "firmware/app/rate_message.hpp"
#include "firmware/wire/can_bits.hpp"
#include "firmware/wire/can_frames.hpp"
#include "firmware/wire/e2e_profile11.hpp"
#include "firmware/wire/health_bits.hpp"
#include "firmware/wire/rate_frame.hpp"

namespace zerorate::wire {

/// 24 bytes of CAN FD with an 11-bit identifier.
struct CanFdFrame {
  std::uint16_t id = 0;
  std::array<std::uint8_t, 24> data{};

  constexpr bool operator==(const CanFdFrame&) const = default;
};

inline constexpr float kCanYawRateLsbDegPerS = 1e-4F;
inline constexpr float kCanFdRateLsbDegPerS = 2e-5F;
/// Limit of class 0 of the deviation; that of class k is 2^k times as large.
inline constexpr float kSigmaClassDegPerS = 1e-4F;
/// Class of a deviation that is not known, or larger than the limit of class 14.
inline constexpr std::uint8_t kSigmaClassNotAvailable = 15;

/// Class of a deviation: the first with a limit that is not smaller.
[[nodiscard]] constexpr std::uint8_t sigma_class(core::AngularRate sigma) {
  float limit = kSigmaClassDegPerS;
  std::uint8_t index = 0;
  // Written so that NaN falls into no class.
  while (index < kSigmaClassNotAvailable && !(sigma.in(core::deg_per_s) <= limit)) {
    limit *= 2.0F;
    ++index;
  }
  return index;
}

/// Deviation of the yaw rate's bias, of a message with `up`. Errors of the three axes are taken as
/// independent.
[[nodiscard]] constexpr core::AngularRate vertical_sigma(const app::RateMessage& message) {
  float variance = 0.0F;
  for (std::size_t i = 0; i < message.axes.size(); ++i) {
    const float share = (*message.up)[i];
    // An axis that lies level has no share, be its deviation infinite.
    if (share == 0.0F) continue;
    const float sigma = share * message.axes[i].sigma.in(core::deg_per_s);
    variance += sigma * sigma;
  }
  return core::deg_per_s(core::square_root(variance));
}

namespace detail {
/// Whether the rates are corrected, and no axis is at full scale.
[[nodiscard]] constexpr bool are_rates_valid(const app::RateMessage& message) {
  return message.has_rate() && message.health.calibrated && !message.health.saturated;
}
/// Yaw rate of 24 bits; not available without a rate or a vertical, and beyond 838 deg/s.
[[nodiscard]] constexpr std::uint32_t encode_yaw_rate(const app::RateMessage& message) {
  if (!message.has_rate() || !message.up) return can_not_available_signed(24);
  return encode_can_signed(message.vertical_rate().in(core::deg_per_s) / kCanYawRateLsbDegPerS, 24);
}
[[nodiscard]] constexpr bool is_yaw_rate_valid(const app::RateMessage& message,
                                               std::uint32_t yaw_rate) {
  return are_rates_valid(message) && yaw_rate != can_not_available_signed(24);
}
[[nodiscard]] constexpr std::uint8_t e2e_counter(std::uint32_t sequence) {
  return static_cast<std::uint8_t>(sequence % kE2eCounts);
}
}  // namespace detail

/// Frame of the yaw rate, the only one of its layout.
/// @param numbered  its number counts the messages on this bus
/// @param id        identifier of the frame
[[nodiscard]] constexpr CanFrame encode_can_yaw(const NumberedMessage& numbered, std::uint16_t id,
                                                const E2eSettings& e2e) {
  const app::RateMessage& message = numbered.message;
  const std::uint32_t yaw_rate = detail::encode_yaw_rate(message);
  CanFrame frame = detail::frame_at(id, 0);
  CanBitWriter out{frame.data};
  out.put(0, 8 * kE2eHeaderBytes);
  out.put(yaw_rate, 24);
  out.put(detail::is_yaw_rate_valid(message, yaw_rate) ? 1U : 0U, 1);
  out.put(static_cast<std::uint32_t>(message.motion), 2);
  out.put(0, 1);
  out.put(message.up ? sigma_class(vertical_sigma(message)) : kSigmaClassNotAvailable, 4);
  out.put(encode_health(message.health), kHealthBits.size());
  e2e_protect(frame.data, e2e, detail::e2e_counter(numbered.sequence));
  return frame;
}

/// Frame of CAN FD, in place of the status frame and those of the axes.
/// @param numbered  its number counts the messages on this bus
/// @param id        identifier of the frame; those of turn, inputs and so on follow it
[[nodiscard]] constexpr CanFdFrame encode_can_fd(const NumberedMessage& numbered, std::uint16_t id,
                                                 const E2eSettings& e2e) {
  ZERORATE_ASSERT(id <= kGreatestCanId);
  const app::RateMessage& message = numbered.message;
  const std::uint32_t yaw_rate = detail::encode_yaw_rate(message);
  CanFdFrame frame{.id = id};
  CanBitWriter out{frame.data};
  out.put(0, 8 * kE2eHeaderBytes);
  out.put(encode_health(message.health), kHealthBits.size());
  out.put(static_cast<std::uint32_t>(message.motion), 2);
  out.put(detail::are_rates_valid(message) ? 1U : 0U, 1);
  out.put(detail::is_yaw_rate_valid(message, yaw_rate) ? 1U : 0U, 1);
  out.put(0, 2);
  for (const app::AxisRate& axis : message.axes) {
    const float count = axis.corrected.in(core::deg_per_s) / kCanFdRateLsbDegPerS;
    out.put(message.has_rate() ? encode_can_signed(count, 28) : can_not_available_signed(28), 28);
  }
  for (const app::AxisRate& axis : message.axes) out.put(detail::encode_can_sigma(axis.sigma), 16);
  out.put(yaw_rate, 24);
  e2e_protect(frame.data, e2e, detail::e2e_counter(numbered.sequence));
  return frame;
}

}  // namespace zerorate::wire
