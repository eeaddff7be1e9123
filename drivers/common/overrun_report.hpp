/// @file
/// When a full FIFO is worth an error.
#pragma once

namespace zerorate::drivers {

/// Lets one overrun be reported once. The error is reported instead of samples, so the FIFO is as
/// full as before when the next reading comes, and a chip that went on meanwhile says "overrun"
/// again: that is the same gap, and the reading has to drain the FIFO, or it would never end.
class OverrunReport {
 public:
  /// @param says_overrun what the chip says at this reading
  /// @return true if the reading is to report it
  constexpr bool is_due(bool says_overrun) {
    is_reported_ = says_overrun && !is_reported_;
    return is_reported_;
  }

 private:
  bool is_reported_ = false;
};

}  // namespace zerorate::drivers
