/// @file
/// Scenarios that the emulated machine goes through, and the count of what they find. Each scenario
/// has a zerorated of its own.
#pragma once

#include <cstdio>

#include "host_tests/emulated/linux/guest/device_world.hpp"

namespace zerorate::emulated {

class Verdict {
 public:
  void begin(const char* scenario) const { std::printf("scenario: %s\n", scenario); }
  /// @param value  is printed: what decided
  template <class Number>
  void check(const char* what, bool is_right, Number value) {
    std::printf("  %s: %s (%.6g)\n", is_right ? "ok" : "FAILED", what, static_cast<double>(value));
    std::fflush(stdout);
    (is_right ? passed_ : failed_) += 1;
  }
  int report() const {
    std::printf("WORLD %d passed, %d failed\n", passed_, failed_);
    return failed_ == 0 ? 0 : 1;
  }

 private:
  int passed_ = 0;
  int failed_ = 0;
};

/// Stops and drives without a fault; leaves /run/recording.csv and /run/monitor.txt.
void drive_undisturbed(DeviceWorld& world, Verdict& verdict, double seconds);

/// Measures the cost of zerorated at 1 kHz.
void measure_cost(DeviceWorld& world, Verdict& verdict);

/// Wrong chip, unplugged, hanging, stuck and noisy buses, a full FIFO.
void break_the_bus(DeviceWorld& world, Verdict& verdict);

/// Data-ready and the odometer.
void break_the_lines(DeviceWorld& world, Verdict& verdict);

/// The wall clock, the disk, the receivers, and ends at a bad moment.
void break_the_system(DeviceWorld& world, Verdict& verdict);

/// Drivers of the kernel in the place of ours, read through IIO; so long with each.
/// @param is_whole  whether the host is quiet, so that stamps count and few polls are late, and the
/// chips' relatives are read too, a third as long
void compare_kernel_drivers(DeviceWorld& world, Verdict& verdict, double seconds, bool is_whole);

/// The relatives alone, on a quiet host.
void compare_kernel_drivers_of_relatives(DeviceWorld& world, Verdict& verdict, double seconds);

}  // namespace zerorate::emulated
