/// @file
/// Lost events, by the gaps in their numbers.
#pragma once

#include <cstdint>

namespace zerorate::hal::linux_os {

/// The kernel numbers the events of a line request from 1 on, in 32 bits that wrap. Nothing is lost
/// as long as each number follows the one before it.
class SequenceGaps {
 public:
  /// How many events are missing between the one before and this one.
  std::uint32_t take(std::uint32_t number) {
    const std::uint32_t missing = number - newest_ - 1U;
    newest_ = number;
    return missing;
  }

 private:
  std::uint32_t newest_ = 0;
};

}  // namespace zerorate::hal::linux_os
