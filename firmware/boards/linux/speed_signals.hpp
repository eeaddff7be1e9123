/// @file
/// Signals of a CAN bus that together show whether the vehicle stands.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/time.hpp"
#include "firmware/boards/linux/message_source.hpp"

namespace zerorate::linux_node {

/// Use of a signal for the decision whether the vehicle stands.
enum class SignalRole : std::uint8_t {
  speed,   ///< speed of a wheel, of the vehicle or of a turn by its wheels; motion beyond the band
  valid,   ///< validity or ignition: with another count than valid_value no speed counts
  counter  ///< alive counter: a frame with the count of the frame before is an old one, sent again
};

/// Signal whose value decides which signals the rest of the frame contains.
struct Multiplexer {
  CanSignal signal;
  std::uint64_t value = 0;  ///< count of a frame that contains the signal
};

struct SpeedSignal {
  CanSignal signal;
  SignalRole role = SignalRole::speed;
  std::optional<std::uint64_t> invalid_from;  ///< lowest count that is no speed
  std::uint64_t valid_value = 0;              ///< count of SignalRole::valid for valid speeds
  std::optional<Multiplexer> multiplexer;
};

/// Follows the signals of several frames. The motion is known while each signal of the roles speed
/// and valid comes within the timeout, and each validity has its valid_value.
class SpeedSignals {
 public:
  SpeedSignals(const std::vector<SpeedSignal>& signals, double dead_band_mps);

  /// Takes a frame.
  /// @return whether it shows motion
  [[nodiscard]] bool hear(const CanFrame& frame, core::Instant now);
  /// True if the frame of the newest call of hear() was of no use: an old one, a short one, or one
  /// with an invalid speed.
  [[nodiscard]] bool was_refused() const { return was_refused_; }
  [[nodiscard]] bool is_known(core::Instant now, core::Duration timeout) const;
  /// True if each validity that was heard has its valid_value.
  [[nodiscard]] bool is_valid() const;

 private:
  struct Watched {
    SpeedSignal settings;
    std::optional<core::Instant> heard_at;
    std::optional<std::uint64_t> count;  ///< count in the newest frame
  };

  /// True if the counter of the frame has moved on, or the frame has none.
  [[nodiscard]] bool is_fresh(const CanFrame& frame);
  [[nodiscard]] bool hear_signal(Watched& watched, const CanFrame& frame, core::Instant now);

  std::vector<Watched> signals_;
  double dead_band_mps_;
  bool was_refused_ = false;
};

}  // namespace zerorate::linux_node
