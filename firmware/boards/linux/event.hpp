/// @file
/// A doorbell between threads that poll() can wait for.
#pragma once

#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <system_error>

namespace zerorate::linux_node {

/// An open descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int descriptor = -1) : descriptor_(descriptor) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor(Descriptor&& other) noexcept : descriptor_(other.release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    reset(other.release());
    return *this;
  }
  ~Descriptor() { reset(-1); }

  [[nodiscard]] int get() const { return descriptor_; }
  [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }
  void reset(int descriptor) {
    if (is_open()) (void)::close(descriptor_);
    descriptor_ = descriptor;
  }

 private:
  int release() {
    const int descriptor = descriptor_;
    descriptor_ = -1;
    return descriptor;
  }
  int descriptor_;
};

/// Throws std::system_error, named by what was tried, where a call gave no descriptor.
[[nodiscard]] inline Descriptor checked_descriptor(int descriptor, const char* tried) {
  if (descriptor < 0) throw std::system_error(errno, std::generic_category(), tried);
  return Descriptor{descriptor};
}

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
