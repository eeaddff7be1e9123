/// @file
/// A vehicle's speed, or its word that it stands, from messages, as an odometer.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "firmware/boards/linux/message_source.hpp"
#include "firmware/boards/linux/speed_signals.hpp"
#include "hal/contract/pulse_input.hpp"

namespace zerorate::linux_node {

struct SpeedSettings {
  MessageOrigin origin;              ///< origin of speeds in m/s
  std::vector<SpeedSignal> signals;  ///< signals of CanFrames
  double dead_band_mps = 0.0;        ///< a greater speed, forwards or backwards, is motion
  core::Duration timeout;            ///< without a message for so long, nothing is known
};

/// The fastest of the speeds in m/s that a datagram states: one to 16 decimal numbers with
/// white space between them, `still` (0) or `moving` (infinite). Numbers of wheels, of the
/// vehicle and of its turn stand beside each other: what turns on the spot moves. nullopt for
/// anything else.
[[nodiscard]] std::optional<double> decode_text(std::string_view text);

/// A PulseInput: each message of a speed beyond the dead band is a pulse, stamped when it is read.
/// Silence is no standstill: without a message for the timeout, and where the socket cannot be
/// opened, reading fails and the vehicle counts as moving.
class SpeedSource {
 public:
  explicit SpeedSource(const SpeedSettings& settings)
      : messages_(settings.origin),
        signals_(settings.signals, settings.dead_band_mps),
        has_signals_(!settings.signals.empty()),
        dead_band_mps_(settings.dead_band_mps),
        timeout_(settings.timeout) {}

  core::Result<hal::PulseBatch, hal::BusError> read_pulses(std::span<core::Instant> stamps);
  /// Becomes readable when there is a message, for poll(); -1 while the socket is not open.
  [[nodiscard]] int descriptor() const { return messages_.descriptor(); }
  /// Reason of the newest failure, as the kernel gave it; of messages that come, ENODATA where the
  /// vehicle calls its speed invalid, and EBADMSG where they cannot be read.
  [[nodiscard]] int error_number() const { return error_number_; }

 private:
  /// Whether a message shows motion.
  [[nodiscard]] bool hear(const Message& message, core::Instant now);
  [[nodiscard]] bool is_known(core::Instant now) const;
  [[nodiscard]] int reason_of_silence(core::Instant now) const;

  MessageSource messages_;
  SpeedSignals signals_;
  bool has_signals_;
  double dead_band_mps_;
  core::Duration timeout_;
  std::optional<core::Instant> heard_at_;
  std::optional<core::Instant> refused_at_;  ///< newest message that could not be used
  int error_number_ = 0;
};
static_assert(hal::PulseInput<SpeedSource>);

}  // namespace zerorate::linux_node
