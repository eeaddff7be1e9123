/// @file
/// The calls by which the back ends reach the kernel. Tests put another class with the same members
/// in its place.
#pragma once

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>

#include "core/base/result.hpp"

namespace zerorate::hal::linux_os {

/// Value that a call returned, or the error number that it left.
using CallResult = core::Result<int, int>;

[[nodiscard]] inline CallResult checked(int returned) {
  if (returned < 0) return core::Unexpected{errno};
  return returned;
}

/// The real ones.
struct SystemCalls {
  static CallResult open(const char* path, int flags) {
    return checked(::open(path, flags | O_CLOEXEC));
  }
  static void close(int descriptor) { (void)::close(descriptor); }
  static CallResult ioctl(int descriptor, unsigned long request, void* argument) {
    return checked(::ioctl(descriptor, request, argument));
  }
};

}  // namespace zerorate::hal::linux_os
