/// @file
/// Signals of a CAN bus that together show whether the vehicle stands.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/time.hpp"
#include "firmware/boards/linux/message_source.hpp"

namespace zerorate::linux_node {

/// Statement of a signal on the motion.
enum class SignalRole : std::uint8_t {
  speed,   ///< beyond the dead band the vehicle moves: a wheel, a speed, a rate of turn by wheels
  valid,   ///< with another count than valid_value the speeds mean nothing: validity, ignition
  counter  ///< a frame in which it stands as in the frame before is an old one, sent again
};

/// Part of a frame that decides which signals the rest of it holds.
struct Multiplexer {
  CanSignal signal;
  std::uint64_t value = 0;  ///< count with which the frame holds the signal
};

struct SpeedSignal {
  CanSignal signal;
  SignalRole role = SignalRole::speed;
  std::optional<std::uint64_t> invalid_from;  ///< counts of a speed from here on are no speed
  std::uint64_t valid_value = 0;              ///< count that SignalRole::valid has to have
  std::optional<Multiplexer> multiplexer;
};

/// Follows the signals of several frames. The motion is known while each signal of a speed or a
/// validity was heard within the timeout, and each validity is as it has to be.
class SpeedSignals {
 public:
  SpeedSignals(const std::vector<SpeedSignal>& signals, double dead_band_mps);

  /// Takes a frame.
  /// @return whether it shows motion
  [[nodiscard]] bool hear(const CanFrame& frame, core::Instant now);
  /// True if a frame of the newest call of hear() was of no use: an old one, a short one, or one
  /// with an invalid speed.
  [[nodiscard]] bool was_refused() const { return was_refused_; }
  [[nodiscard]] bool is_known(core::Instant now, core::Duration timeout) const;
  /// True if each validity that was heard is as it has to be.
  [[nodiscard]] bool is_valid() const;

 private:
  struct Watched {
    SpeedSignal settings;
    std::optional<core::Instant> heard_at;
    std::optional<std::uint64_t> count;  ///< count in the newest frame
  };

  /// True if the counter of the frame has moved on, or it has none.
  [[nodiscard]] bool is_fresh(const CanFrame& frame);
  [[nodiscard]] bool hear_signal(Watched& watched, const CanFrame& frame, core::Instant now);

  std::vector<Watched> signals_;
  double dead_band_mps_;
  bool was_refused_ = false;
};

}  // namespace zerorate::linux_node
