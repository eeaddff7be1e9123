/// @file
/// An event between threads that poll() can wait for.
#pragma once

#include <sys/eventfd.h>
#include <unistd.h>

#include <cstdint>

#include "hal/linux/descriptor.hpp"

namespace zerorate::linux_node {

using hal::linux_os::checked_descriptor;
using hal::linux_os::Descriptor;

/// signal() makes the descriptor readable until clear().
class Event {
 public:
  Event() : descriptor_(checked_descriptor(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC), "eventfd")) {}

  [[nodiscard]] int descriptor() const { return descriptor_.get(); }
  void signal() const {
    const std::uint64_t one = 1;
    (void)!::write(descriptor_.get(), &one, sizeof one);  // fails only when it is readable already
  }
  void clear() const {
    std::uint64_t signals = 0;
    (void)!::read(descriptor_.get(), &signals,
                  sizeof signals);  // fails only when it was not signalled
  }

 private:
  Descriptor descriptor_;
};

}  // namespace zerorate::linux_node
