/// @file
/// The calls by which the back ends reach the kernel, and a node in /dev that may disappear and
/// come back.
#pragma once

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <ctime>
#include <string>
#include <utility>

#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "hal/linux/bus_error.hpp"
#include "hal/linux/clock.hpp"

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
  /// Locks bytes of the file to this descriptor; EAGAIN where another one holds some of them.
  static CallResult lock(int descriptor, off_t first, off_t count) {
    flock bytes{};
    bytes.l_type = F_WRLCK;
    bytes.l_whence = SEEK_SET;
    bytes.l_start = first;
    bytes.l_len = count;
    return checked(::fcntl(descriptor, F_OFD_SETLK, &bytes));
  }
  static core::Instant now() { return KernelClock::now(); }
  /// Sleeps until this time of now(); not at all if it has passed.
  static void wait_until(core::Instant time) {
    constexpr std::int64_t kSecond_ns = 1'000'000'000;
    const timespec until{.tv_sec = time.ns() / kSecond_ns, .tv_nsec = time.ns() % kSecond_ns};
    while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
  }
};

/// Opens its node at the first use, and again at the first use after the device was gone: a sensor
/// that is unplugged and plugged in again needs no restart of the program.
template <class System>
class DeviceFile {
 public:
  DeviceFile(std::string path, Subsystem subsystem, System system)
      : path_(std::move(path)), subsystem_(subsystem), system_(std::move(system)) {}
  DeviceFile(const DeviceFile&) = delete;
  DeviceFile& operator=(const DeviceFile&) = delete;
  ~DeviceFile() { close(); }

  [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }
  /// Reason of the newest failure as the kernel gave it; 0 after a call that succeeded.
  [[nodiscard]] int error_number() const { return error_number_; }

  core::Result<void, BusError> open() {
    const CallResult opened = system_.open(path_.c_str(), O_RDWR);
    if (!opened) return failed(opened.error());
    descriptor_ = *opened;
    error_number_ = 0;
    return {};
  }
  /// Reserves one chip behind the node, so that no two programs read it and each gets half of the
  /// samples. Binds those programs alone that ask, as the ones of this project do.
  /// @param chip  its number: bytes of the node stand for chips
  /// @return not_present with EBUSY where another open file has reserved it
  core::Result<void, BusError> reserve(off_t chip) {
    const CallResult locked = system_.lock(descriptor_, chip, 1);
    if (locked || (locked.error() != EAGAIN && locked.error() != EACCES)) return {};
    close();
    error_number_ = EBUSY;
    return core::Unexpected{BusError::not_present};
  }
  void close() {
    if (is_open()) system_.close(descriptor_);
    descriptor_ = -1;
  }

  /// Sets what not every driver lets set.
  void set(unsigned long request, unsigned long value) {
    // NOLINTNEXTLINE(performance-no-int-to-ptr): ioctl() takes numbers and pointers alike
    (void)system_.ioctl(descriptor_, request, reinterpret_cast<void*>(value));
  }

  /// Answer of the driver. A device that is gone is closed.
  core::Result<int, BusError> ioctl(unsigned long request, void* argument) {
    const CallResult answered = system_.ioctl(descriptor_, request, argument);
    if (!answered) return failed(answered.error());
    error_number_ = 0;
    return *answered;
  }

 private:
  core::Unexpected<BusError> failed(int error) {
    error_number_ = error;
    const BusError reason = to_bus_error(error, subsystem_);
    if (reason == BusError::not_present) close();
    return core::Unexpected{reason};
  }

  std::string path_;
  Subsystem subsystem_;
  [[no_unique_address]] System system_;
  int descriptor_ = -1;
  int error_number_ = 0;
};

}  // namespace zerorate::hal::linux_os
