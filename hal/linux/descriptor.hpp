/// @file
/// An open file, socket or device that closes itself.
#pragma once

#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace zerorate::hal::linux_os {

/// Owns a descriptor; -1 is none.
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

}  // namespace zerorate::hal::linux_os
