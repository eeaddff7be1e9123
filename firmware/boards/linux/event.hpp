/// @file
/// A doorbell between threads that poll() can wait for.
#pragma once

#include <sys/eventfd.h>
#include <unistd.h>

#include <cstdint>

#include "hal/linux/descriptor.hpp"

namespace zerorate::linux_node {

using hal::linux_os::checked_descriptor;
using hal::linux_os::Descriptor;

/// ring() makes the descriptor readable until hush().
class Event {
 public:
  Event() : descriptor_(checked_descriptor(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC), "eventfd")) {}

  [[nodiscard]] int descriptor() const { return descriptor_.get(); }
  void ring() const {
    const std::uint64_t one = 1;
    (void)!::write(descriptor_.get(), &one, sizeof one);  // fails only when it rings already
  }
  void hush() const {
    std::uint64_t rings = 0;
    (void)!::read(descriptor_.get(), &rings, sizeof rings);  // fails only when it did not ring
  }

 private:
  Descriptor descriptor_;
};

}  // namespace zerorate::linux_node
