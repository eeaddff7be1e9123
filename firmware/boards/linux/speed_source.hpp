/// @file
/// A vehicle's speed, or its word that it stands, from messages, as an odometer.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "firmware/boards/linux/message_source.hpp"
#include "hal/contract/pulse_input.hpp"

namespace zerorate::linux_node {

struct SpeedSettings {
  MessageOrigin origin;        ///< origin of speeds in m/s
  double dead_band_mps = 0.0;  ///< a greater speed, forwards or backwards, is motion
  core::Duration timeout;      ///< without a message for so long, nothing is known
};

/// Speed in m/s that a datagram states: a decimal number, `still` (0) or `moving` (infinite). White
/// space around it does not count. nullopt for anything else.
[[nodiscard]] std::optional<double> decode_text(std::string_view text);

/// A PulseInput: each message of a speed beyond the dead band is a pulse, stamped when it is read.
/// Silence is no standstill: without a message for the timeout, and where the socket cannot be
/// opened, reading fails and the vehicle counts as moving.
class SpeedSource {
 public:
  explicit SpeedSource(const SpeedSettings& settings)
      : messages_(settings.origin),
        dead_band_mps_(settings.dead_band_mps),
        timeout_(settings.timeout) {}

  core::Result<hal::PulseBatch, hal::BusError> read_pulses(std::span<core::Instant> stamps);
  /// Becomes readable when there is a message, for poll(); -1 while the socket is not open.
  [[nodiscard]] int descriptor() const { return messages_.descriptor(); }
  /// Reason of the newest failure, as the kernel gave it.
  [[nodiscard]] int error_number() const { return error_number_; }

 private:
  MessageSource messages_;
  double dead_band_mps_;
  core::Duration timeout_;
  std::optional<core::Instant> heard_at_;
  int error_number_ = 0;
};
static_assert(hal::PulseInput<SpeedSource>);

}  // namespace zerorate::linux_node
