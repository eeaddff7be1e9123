/// @file
/// When a sink tries again what failed.
#pragma once

namespace zerorate::linux_node {

/// Messages between two attempts to open what was not there, such as a FIFO's reader.
inline constexpr int kRetryAfter = 100;

/// Says when to try again.
class RetryCounter {
 public:
  bool is_due() {
    if (++waited_ < kRetryAfter) return false;
    waited_ = 0;
    return true;
  }

 private:
  int waited_ = 0;
};

}  // namespace zerorate::linux_node
